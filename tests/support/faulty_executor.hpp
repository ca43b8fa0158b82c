// An Executor that lets another one work and then answers wrongly, late or twice, as told.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <utility>
#include <vector>

#include "raykiln/workers/executor.hpp"

namespace raykiln::tests {

enum class Fault {
  kNone,
  kFail,             ///< an error instead of a result
  kTwice,            ///< the result, and the same again
  kFailThenDeliver,  ///< an error at once, and later the result all the same
  kHold              ///< the result, when release() is called
};

class FaultyExecutor final : public server::Executor {
 public:
  using Done = std::function<void(server::TileOutcome)>;

  FaultyExecutor(server::Executor& inner, std::function<Fault(const server::TileTask&)> choose)
      : inner_(inner), choose_(std::move(choose)) {}

  void start(server::TileTask task, Done done) override {
    switch (choose_(task)) {
      case Fault::kNone: return inner_.start(std::move(task), std::move(done));
      case Fault::kFail: return done(failure(task));
      case Fault::kTwice:
        return inner_.start(std::move(task), [done](server::TileOutcome outcome) {
          done(outcome);
          done(std::move(outcome));
        });
      case Fault::kFailThenDeliver:
        done(failure(task));
        return inner_.start(std::move(task), std::move(done));
      case Fault::kHold:
        // Its own stop source never asks: this result comes whole, however late.
        task.stop = {};
        return inner_.start(std::move(task), [this, done](server::TileOutcome outcome) {
          const std::scoped_lock lock(mutex_);
          held_.emplace_back(done, std::move(outcome));
          arrived_.notify_all();
        });
    }
  }
  [[nodiscard]] int concurrency() const override { return inner_.concurrency(); }

  void wait_held(std::size_t n) {
    std::unique_lock lock(mutex_);
    arrived_.wait(lock, [&] { return held_.size() >= n; });
  }
  void release() {
    std::vector<std::pair<Done, server::TileOutcome>> now;
    {
      const std::scoped_lock lock(mutex_);
      now.swap(held_);
    }
    for (auto& [done, outcome] : now) done(std::move(outcome));
  }

 private:
  static server::TileOutcome failure(const server::TileTask& task) {
    server::TileOutcome outcome;
    outcome.job = task.job;
    outcome.item = task.item;
    outcome.error = server::Error{server::ErrorKind::kInternal, "worker_failed", "injected fault", ""};
    return outcome;
  }

  server::Executor& inner_;
  std::function<Fault(const server::TileTask&)> choose_;
  std::mutex mutex_;
  std::condition_variable arrived_;
  std::vector<std::pair<Done, server::TileOutcome>> held_;
};

}  // namespace raykiln::tests
