// Batches on a whole server core: bounds, and what another process finds.
#include <gtest/gtest.h>

#include "raykiln/batches/batch_runner.hpp"
#include "support/server_rig.hpp"
#include "support/temp_directory.hpp"

namespace raykiln::tests {
namespace {

using namespace server;

struct Runner : testing::Test {
  TempDirectory directory;
  ServerRig rig{directory.path()};
  std::string scene = rig.add_scene("a room")->scene.record.id;
  std::unique_ptr<BatchRecords> records = std::move(*BatchRecords::open(rig.config.store));
  BatchLimits limits;
  std::unique_ptr<BatchRunner> runner;

  void open() {
    runner.reset();
    runner = std::make_unique<BatchRunner>(BatchRunner::Parts{*rig.scheduler, *records, rig.clock, Log()}, limits);
  }
  void SetUp() override { open(); }

  [[nodiscard]] BatchRequest request(std::size_t items, std::uint64_t samples = 2) const {
    BatchRequest batch;
    for (std::size_t i = 0; i < items; ++i) {
      BatchItem item;
      item.name = std::string("p").append(std::to_string(i));
      item.request = small_job(scene, samples);
      item.request.seed = i;
      batch.items.push_back(std::move(item));
    }
    return batch;
  }
  Result<BatchPtr> submit(const BatchRequest& batch, const std::string& key = "") {
    return answer_of<BatchPtr>([&](auto reply) { runner->submit(batch, key, reply); });
  }
  Result<BatchPtr> get(const BatchId& id) {
    return answer_of<BatchPtr>([&](auto reply) { runner->get(id, reply); });
  }
  BatchPtr wait(const BatchId& id) {
    for (int i = 0; i < 6000; ++i) {
      const auto batch = get(id);
      if (batch && (*batch)->finished) return *batch;
      std::this_thread::sleep_for(10ms);
    }
    throw std::runtime_error("the batch does not end");
  }
};

TEST_F(Runner, BatchesAreBoundedAndTheOldestThatEndedGo) {
  limits.running = 2;
  limits.kept = 3;
  open();
  const auto endless = submit(request(1, 1'000'000));
  const auto first = submit(request(1)), second = [&] {
    wait((*first)->id);
    return submit(request(2));
  }();
  wait((*second)->id);
  EXPECT_TRUE(submit(request(3)));
  EXPECT_EQ(get((*first)->id).error().code, "batch_not_found") << "the oldest that has ended";
  EXPECT_TRUE(get((*endless)->id)) << "what runs stays";
  limits.running = 1;
  open();
  const auto full = submit(request(1));
  ASSERT_FALSE(full);
  EXPECT_EQ(full.error().code, "queue_full");
  EXPECT_TRUE(full.error().retry_after_s);
  EXPECT_TRUE(answer_of<BatchPtr>([&](auto reply) { runner->cancel((*endless)->id, reply); }));
  EXPECT_EQ(wait((*endless)->id)->state(), BatchState::kCancelled);
}

TEST_F(Runner, JobsOfAllBatchesAreBoundedTogether) {
  limits.jobs = 1;
  open();
  BatchRequest high = request(2), low = request(2);
  low.reuse = high.reuse = false;
  high.priority = 20;
  const auto one = submit(low), two = submit(high);
  wait((*one)->id);
  const auto after = wait((*two)->id);
  EXPECT_LT(*after->finished, *wait((*one)->id)->finished) << "the higher priority went first";
  EXPECT_EQ(after->state(), BatchState::kCompleted);
}

TEST_F(Runner, AFullQueueMakesItemsWait) {
  rig.scheduler.reset();
  rig.config.scheduler.max_queued_jobs = 1;
  rig.config.scheduler.max_active_jobs = 1;
  runner.reset();
  rig.start();
  open();
  BatchRequest batch = request(8);
  batch.max_active = 8;
  const auto end = wait((*submit(batch))->id);
  EXPECT_EQ(end->count(ItemState::kCompleted), 8U);
}

TEST_F(Runner, ACancelOutlivesTheProcess) {
  const auto batch = submit(request(3, 1'000'000));
  ASSERT_TRUE(batch);
  for (int i = 0; i < 1000 && (*get((*batch)->id))->items()[0].job.empty(); ++i) std::this_thread::sleep_for(5ms);
  // As if the process had died after the cancel was stored, and before the jobs knew.
  auto stored = records->all();
  auto dead = decode_batch(stored->front().request, stored->front().state);
  ASSERT_TRUE(dead);
  dead->cancelled = true;
  for (std::size_t i = 1; i < 3; ++i) dead->enter(i, ItemState::kCancelled);
  runner.reset();
  ASSERT_TRUE(records->set_state(dead->id, encode_batch_state(*dead)));
  open();
  EXPECT_EQ(wait(dead->id)->state(), BatchState::kCancelled);
}

TEST_F(Runner, ADamagedRecordIsLeftOut) {
  ASSERT_TRUE(records->add({"b_bad", "rubbish", "more"}));
  EXPECT_FALSE(records->add({"b_bad", "again", ""})) << "an id is there once";
  open();
  EXPECT_EQ(get("b_bad").error().code, "batch_not_found");
  EXPECT_TRUE(submit(request(1)));
}

TEST_F(Runner, AfterTheEndItSaysSo) {
  runner->stop();
  EXPECT_EQ(get("b").error().code, "shutting_down");
}

}  // namespace
}  // namespace raykiln::tests
