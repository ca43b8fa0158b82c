#include <gtest/gtest.h>

#include <atomic>
#include <future>

#include "raykiln/workers/local_pool.hpp"
#include "support/fake_intake.hpp"

namespace raykiln::server {
namespace {

WorkerSettings threads(int n) {
  WorkerSettings settings;
  settings.threads = n;
  return settings;
}

void nest(render::TaskRunner& runner, int depth, std::atomic<int>& leaves) {
  if (depth == 0) {
    ++leaves;
    return;
  }
  std::vector<std::function<void()>> tasks(4, [&, depth] { nest(runner, depth - 1, leaves); });
  runner.run(tasks);
}

TEST(LocalPool, NestedRunsEndForAnyNumberOfThreads) {
  for (const int n : {1, 2, 7}) {
    LocalPool pool(threads(n));
    const auto runner = pool.task_runner({}, {});
    std::atomic<int> leaves{0};
    nest(*runner, 5, leaves);
    EXPECT_EQ(leaves, 1024);
  }
}

TEST(LocalPool, RethrowsWhatAClosureThrows) {
  LocalPool pool(threads(2));
  const auto runner = pool.task_runner({}, {});
  std::atomic<int> ran{0};
  std::vector<std::function<void()>> tasks(8, [&] { ++ran; });
  tasks[3] = [] { throw std::runtime_error("x"); };
  EXPECT_THROW(runner->run(tasks), std::runtime_error);
  EXPECT_EQ(ran, 7);
}

TEST(LocalPool, RunnersWorkAfterStop) {
  LocalPool pool(threads(2));
  const auto runner = pool.task_runner({}, {});
  pool.stop();
  std::atomic<int> leaves{0};
  nest(*runner, 2, leaves);
  EXPECT_EQ(leaves, 16);
}

TileTask task_of(const std::shared_ptr<const render::PreparedScene>& scene) {
  TileTask task;
  task.job = std::string(1, 'j');
  task.scene = scene;
  task.settings.width = task.settings.height = 32;
  task.item.id = 1;
  task.item.end_block = 1;
  task.item.parts = {{0, {0, 0, 16, 32}}, {1, {16, 0, 32, 32}}};
  task.blocks = {render::sample_block(0)};
  return task;
}

TEST(LocalPool, AnswersEveryTaskOnce) {
  const auto scene = std::make_shared<const render::Scene>(tests::tiny_scene());
  render::SerialTaskRunner serial;
  const auto prepared = render::prepare(scene, render::build_scene_tree(*scene, {}, serial));
  std::atomic<int> answers{0}, results{0}, stopped{0}, refused{0};
  {
    LocalPool pool(threads(2));
    std::stop_source stop;
    stop.request_stop();
    for (int i = 0; i < 50; ++i) {
      TileTask task = task_of(prepared);
      if (i % 2 == 1) task.stop = stop.get_token();
      pool.start(std::move(task), [&](TileOutcome outcome) {
        ++answers;
        results += static_cast<int>(outcome.results.size());
        stopped += outcome.stopped ? 1 : 0;
      });
    }
    while (answers < 50) std::this_thread::yield();
    pool.stop();
    pool.start(task_of(prepared), [&](TileOutcome outcome) {
      refused += outcome.error && outcome.error->code == "worker_stopped" ? 1 : 0;
    });
  }
  EXPECT_EQ(answers, 50);
  EXPECT_EQ(results, 50) << "two parts for each of the 25 that were not stopped";
  EXPECT_EQ(stopped, 25) << "a stop before the start counts";
  EXPECT_EQ(refused, 1);
}

}  // namespace
}  // namespace raykiln::server
