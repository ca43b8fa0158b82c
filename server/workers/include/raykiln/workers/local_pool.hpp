// Render threads of this process.
#pragma once

#include <functional>
#include <memory>

#include "raykiln/accel/task_runner.hpp"
#include "raykiln/base/config.hpp"
#include "raykiln/workers/executor.hpp"

namespace raykiln::server {

class PoolState;

/// Tasks start in the order of start(). Threads run at a lower priority of the operating system, so
/// that whoever talks to clients stays quick.
class LocalPool final : public Executor {
 public:
  explicit LocalPool(const WorkerSettings& settings);
  ~LocalPool() override;  ///< stop()

  void start(TileTask task, std::function<void(TileOutcome)> done) override;
  [[nodiscard]] int concurrency() const override;

  /// Lets running tasks end, answers waiting ones with "worker_stopped", joins.
  void stop();

  /// A runner for builds: closures run on the calling thread and on pool threads that have no tile to
  /// render. A caller never waits for a closure that nobody has begun, so that nested calls cannot
  /// deadlock. Runs on the calling thread alone after stop().
  [[nodiscard]] std::unique_ptr<render::TaskRunner> task_runner(
      std::function<void(double)> progress, std::function<bool()> stop_requested);

 private:
  std::shared_ptr<PoolState> state_;
};

}  // namespace raykiln::server
