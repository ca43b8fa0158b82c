// One preparation under way and those who wait for it.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>

#include "raykiln/workers/scene_cache.hpp"

namespace raykiln::server {

/// Safe to use from any thread. Callbacks are called without a lock.
class Flight {
 public:
  Flight(std::string scene, const TreeBudget& tree) : scene_id(std::move(scene)), budget(tree) {}

  struct Waiter {
    std::function<void(PrepareProgress)> progress;
    std::function<void(Result<ReadyScene>)> done;
  };

  /// Nothing when nobody waits any more: the flight is being given up.
  [[nodiscard]] std::optional<std::uint64_t> join(Waiter waiter);
  /// True when that was the last one: the flight has been told to stop.
  bool leave(std::uint64_t waiter);

  void report(PrepareProgress progress);
  void finish(const Result<ReadyScene>& result);

  [[nodiscard]] PrepareProgress progress() const;
  [[nodiscard]] bool wanted() const { return !stop_.stop_requested(); }
  [[nodiscard]] std::stop_token token() const { return stop_.get_token(); }
  void stop() { stop_.request_stop(); }

  const std::string scene_id;
  const TreeBudget budget;

 private:
  mutable std::mutex mutex_;
  std::map<std::uint64_t, Waiter> waiters_;
  std::uint64_t next_ = 1;
  PrepareProgress progress_{PrepareStage::kWaiting, 0.0};
  std::stop_source stop_;
};

}  // namespace raykiln::server
