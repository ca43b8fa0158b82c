// The newest snapshot of each live job, and who is to be woken when there is a newer one.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>

#include "raykiln/base/result.hpp"
#include "raykiln/jobs/job_snapshot.hpp"

namespace raykiln::server {

using SnapshotPtr = std::shared_ptr<const JobSnapshot>;

/// One subscriber's end. Memory: one flag and one pointer, however slow the reader is. Destroying it
/// ends the subscription; a wake-up that is under way may still be running then, so that `wake` must
/// own what it touches.
class Subscription {
 public:
  virtual ~Subscription() = default;
  /// The newest snapshot if it is newer than the last one taken, else null. The first call always
  /// gives one. A final snapshot is the last. Safe from any thread.
  [[nodiscard]] virtual SnapshotPtr take() = 0;
};

/// Who subscribes: clients are bounded here; what the server itself watches is bounded by whoever watches, and
/// takes no client's place.
enum class Seat : bool { kClient, kServer };

/// Safe to use from any thread; `wake` is never called under a lock.
class EventHub {
 public:
  explicit EventHub(std::size_t max_clients);
  ~EventHub();
  EventHub(const EventHub&) = delete;
  EventHub& operator=(const EventHub&) = delete;

  /// Stores the snapshot as the job's newest and wakes those who watch it: once until they take().
  /// Older revisions than the newest are ignored. A final snapshot is handed to all subscribers and
  /// the job is forgotten.
  void publish(SnapshotPtr snapshot);

  /// Watches from `current` on. `wake` runs on the publisher's thread and must only post. "too_many_streams"
  /// (kUnavailable) when there are as many clients as there may be.
  [[nodiscard]] Result<std::unique_ptr<Subscription>> subscribe(SnapshotPtr current,
                                                                std::function<void()> wake,
                                                                Seat seat = Seat::kClient);

  [[nodiscard]] std::size_t clients() const;

 private:
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace raykiln::server
