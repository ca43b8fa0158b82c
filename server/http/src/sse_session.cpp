#include "raykiln/http/sse_session.hpp"

#include <algorithm>

namespace raykiln::server {

SseSession::SseSession(SseTiming timing, SteadyTime now)
    : timing_(timing), last_write_(now), next_event_(now) {}

SseSession::Action SseSession::next(SteadyTime now) const {
  if (finished_ || stopping_) return {Do::kEnd};
  if (dirty_ && now >= next_event_) return {Do::kPoll};
  const SteadyTime beat = last_write_ + timing_.heartbeat;
  if (now >= beat) return {Do::kHeartbeat};
  return {Do::kWait, dirty_ ? std::min(beat, next_event_) : beat};
}

void SseSession::polled(const FeedStep& step, SteadyTime now) {
  dirty_ = false;
  finished_ = step.finished;
  if (!step.event.empty()) next_event_ = now + timing_.least_gap;
}

}  // namespace raykiln::server
