#include "raykiln/workers/local_pool.hpp"

#include <algorithm>
#include <thread>
#include <utility>

#include "pool_state.hpp"

namespace raykiln::server {
namespace {

int thread_count(const WorkerSettings& settings) {
  if (settings.threads > 0) return settings.threads;
  return static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
}

class PoolTaskRunner final : public render::TaskRunner {
 public:
  PoolTaskRunner(std::shared_ptr<PoolState> pool, std::function<void(double)> progress,
                 std::function<bool()> stop_requested)
      : pool_(std::move(pool)),
        progress_(std::move(progress)),
        stop_requested_(std::move(stop_requested)) {}

  void run(std::span<const std::function<void()>> tasks) override { pool_->run_closures(tasks); }
  void progress(double fraction) override {
    if (progress_) progress_(fraction);
  }
  [[nodiscard]] bool stop_requested() const override { return stop_requested_ && stop_requested_(); }
  [[nodiscard]] int concurrency() const override { return pool_->threads() + 1; }

 private:
  std::shared_ptr<PoolState> pool_;
  std::function<void(double)> progress_;
  std::function<bool()> stop_requested_;
};

}  // namespace

LocalPool::LocalPool(const WorkerSettings& settings)
    : state_(std::make_shared<PoolState>(thread_count(settings), settings.niceness)) {}
LocalPool::~LocalPool() { stop(); }

void LocalPool::start(TileTask task, std::function<void(TileOutcome)> done) {
  state_->start(std::move(task), std::move(done));
}
int LocalPool::concurrency() const { return state_->threads(); }
void LocalPool::stop() { state_->stop(); }

std::unique_ptr<render::TaskRunner> LocalPool::task_runner(std::function<void(double)> progress,
                                                           std::function<bool()> stop_requested) {
  return std::make_unique<PoolTaskRunner>(state_, std::move(progress), std::move(stop_requested));
}

}  // namespace raykiln::server
