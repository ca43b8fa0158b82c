#include "flight.hpp"

#include <vector>

namespace raykiln::server {

std::optional<std::uint64_t> Flight::join(Waiter waiter) {
  const std::scoped_lock lock(mutex_);
  if (stop_.stop_requested()) return std::nullopt;
  waiters_.emplace(next_, std::move(waiter));
  return next_++;
}

bool Flight::leave(std::uint64_t waiter) {
  Waiter dropped;  // declared first: dies after the lock is released
  const std::scoped_lock lock(mutex_);
  const auto found = waiters_.find(waiter);
  if (found == waiters_.end()) return false;
  dropped = std::move(found->second);
  waiters_.erase(found);
  if (!waiters_.empty()) return false;
  stop_.request_stop();
  return true;
}

void Flight::report(PrepareProgress progress) {
  std::vector<std::function<void(PrepareProgress)>> calls;
  {
    const std::scoped_lock lock(mutex_);
    progress_ = progress;
    for (const auto& entry : waiters_) calls.push_back(entry.second.progress);
  }
  for (const auto& call : calls) {
    if (call) call(progress);
  }
}

void Flight::finish(const Result<ReadyScene>& result) {
  std::map<std::uint64_t, Waiter> waiters;
  {
    const std::scoped_lock lock(mutex_);
    waiters.swap(waiters_);
  }
  for (const auto& entry : waiters) entry.second.done(result);
}

PrepareProgress Flight::progress() const {
  const std::scoped_lock lock(mutex_);
  return progress_;
}

}  // namespace raykiln::server
