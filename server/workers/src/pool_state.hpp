// What the threads of a pool share.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <span>
#include <thread>
#include <vector>

#include "raykiln/workers/executor.hpp"

namespace raykiln::server {

class PoolState {
 public:
  PoolState(int threads, int niceness);
  ~PoolState();
  PoolState(const PoolState&) = delete;
  PoolState& operator=(const PoolState&) = delete;

  void start(TileTask task, std::function<void(TileOutcome)> done);
  void run_closures(std::span<const std::function<void()>> closures);
  void stop();
  [[nodiscard]] int threads() const { return threads_; }

 private:
  struct Waiting {
    TileTask task;
    std::function<void(TileOutcome)> done;
  };
  /// One call of run_closures; lives on the stack of the caller, who leaves last.
  struct Group {
    std::span<const std::function<void()>> closures;
    std::size_t next = 0;
    std::size_t running = 0;
    std::exception_ptr fault{};
    std::condition_variable ended;
  };

  void work(int worker, int niceness);
  void run_one(Group& group, std::unique_lock<std::mutex>& lock);
  void run_tile(Waiting waiting, int worker, SteadyTime free_since);

  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<Waiting> waiting_;
  std::list<Group*> groups_;  ///< with closures that nobody has begun
  bool stopping_ = false;
  const int threads_;
  std::vector<std::jthread> workers_;
};

}  // namespace raykiln::server
