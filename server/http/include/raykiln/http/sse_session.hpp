// When an event stream polls, writes, beats, waits and ends: the decisions without the socket.
#pragma once

#include <chrono>
#include <string_view>

#include "raykiln/api/message.hpp"
#include "raykiln/base/clock.hpp"

namespace raykiln::server {

inline constexpr std::string_view kSsePreamble = "retry: 2000\n\n";
inline constexpr std::string_view kSseHeartbeat = ": heartbeat\n\n";

struct SseTiming {
  std::chrono::milliseconds least_gap{25};      ///< between two events
  std::chrono::milliseconds heartbeat{15'000};  ///< longest silence
};

/// Latest wins: while a write is on its way to a slow reader, any number of wake-ups come to one
/// dirty flag. An event that the feed has marked as finished is always written before the end.
class SseSession {
 public:
  enum class Do {
    kPoll,       ///< ask the feed, then call polled()
    kHeartbeat,  ///< write kSseHeartbeat, then call written()
    kWait,       ///< until Action::until or a wake-up
    kEnd,
  };
  struct Action {
    Do what;
    SteadyTime until{};
  };

  SseSession(SseTiming timing, SteadyTime now);

  [[nodiscard]] Action next(SteadyTime now) const;

  void woken() { dirty_ = true; }
  /// The server is stopping: no further event.
  void stop() { stopping_ = true; }
  /// After this the shell writes the step's event, if it has one, and calls written().
  void polled(const FeedStep& step, SteadyTime now);
  void written(SteadyTime now) { last_write_ = now; }

 private:
  SseTiming timing_;
  SteadyTime last_write_;
  SteadyTime next_event_;  ///< not before
  bool dirty_ = true;      ///< the first event is due at once
  bool finished_ = false;
  bool stopping_ = false;
};

}  // namespace raykiln::server
