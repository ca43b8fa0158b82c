// Batches on a whole server core: bounds, and what another process finds.
#include <gtest/gtest.h>

#include <atomic>

#include "raykiln/batches/batch_runner.hpp"
#include "support/server_rig.hpp"
#include "support/temp_directory.hpp"

namespace raykiln::tests {
namespace {

using namespace server;

/// Counts what is written, and fails when it is told to.
class WatchedRecords final : public BatchRecords {
 public:
  explicit WatchedRecords(std::unique_ptr<BatchRecords> real) : real_(std::move(real)) {}
  Status add(const BatchRecord& batch, const std::vector<std::string>& instead_of) override {
    if (disk_is_full) return full();
    return real_->add(batch, instead_of);
  }
  Status set_state(const std::string& id, const std::string& state) override {
    ++writes;
    if (disk_is_full) return full();
    return real_->set_state(id, state);
  }
  Result<std::vector<BatchRecord>> all() override { return real_->all(); }

  std::atomic<int> writes = 0;
  std::atomic<bool> disk_is_full = false;

 private:
  static Error full() { return {ErrorKind::kStorageFull, "storage_full", "the disk of the store is full", ""}; }
  std::unique_ptr<BatchRecords> real_;
};

struct Runner : testing::Test {
  TempDirectory directory;
  ServerRig rig{directory.path()};
  std::string scene = rig.add_scene("a room")->scene.record.id;
  std::unique_ptr<WatchedRecords> records =
      std::make_unique<WatchedRecords>(std::move(*BatchRecords::open(rig.config.store)));
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
  template <class Holds>
  BatchPtr wait_until(const BatchId& id, const Holds& holds) {
    for (int i = 0; i < 6000; ++i) {
      const auto batch = get(id);
      if (batch && holds(**batch)) return *batch;
      std::this_thread::sleep_for(10ms);
    }
    throw std::runtime_error("the batch does not come so far");
  }
  BatchPtr wait(const BatchId& id) {
    return wait_until(id, [](const Batch& batch) { return batch.finished.has_value(); });
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
  low.items[0].request.stop.samples = 1'000'000;  // has the only place until both are there
  const auto one = submit(low), two = submit(high);
  const auto first = wait_until((*one)->id, [](const Batch& b) { return !b.items()[0].job.empty(); });
  EXPECT_TRUE(rig.cancel(first->items()[0].job));
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

TEST_F(Runner, AFullQueueMovesNothingAndWritesNothing) {
  rig.scheduler.reset();
  rig.config.scheduler.max_queued_jobs = 1;
  rig.config.scheduler.max_active_jobs = 1;
  runner.reset();
  rig.start();
  open();
  const auto running = rig.submit(small_job(scene, 1'000'000));
  rig.follow(running->job.id, [](const JobSnapshot& job) { return job.state == JobState::kRendering; });
  ASSERT_TRUE(rig.submit(small_job(scene, 999'999)));
  const auto batch = submit(request(3));
  std::this_thread::sleep_for(700ms);  // asked for again some times
  const auto still = get((*batch)->id);
  EXPECT_EQ((*still)->revision, 1U);
  EXPECT_EQ((*still)->count(ItemState::kWaiting), 3U);
  EXPECT_EQ(records->writes, 0);
}

TEST_F(Runner, ReadsWriteNothing) {
  const auto batch = submit(request(1, 1'000'000));
  wait_until((*batch)->id, [](const Batch& b) { return !b.items()[0].job.empty(); });
  const int before = records->writes;
  EXPECT_EQ(before, 1) << "its job is known";
  for (int i = 0; i < 50; ++i) {
    EXPECT_TRUE(get((*batch)->id));
    EXPECT_TRUE(answer_of<BatchPage>([&](auto reply) { runner->list("", 10, reply); }));
  }
  EXPECT_EQ(records->writes, before);
}

TEST_F(Runner, AnEndThatTheStoreDidNotTakeIsStoredLater) {
  limits.store_again = 5ms;
  rig.scheduler.reset();
  rig.config.scheduler.max_active_jobs = 1;
  runner.reset();
  rig.start();
  open();
  // It cannot end before the disk is full: another job has the only place.
  const auto other = rig.submit(small_job(scene, 1'000'000));
  const auto batch = submit(request(1, 64));
  wait_until((*batch)->id, [](const Batch& b) { return !b.items()[0].job.empty(); });
  records->disk_is_full = true;
  EXPECT_TRUE(rig.cancel(other->job.id));
  EXPECT_EQ(wait((*batch)->id)->state(), BatchState::kCompleted) << "told all the same";
  const auto stored = [&] {
    const auto all = records->all();
    return decode_batch(all->front().request, all->front().state)->state();
  };
  EXPECT_EQ(stored(), BatchState::kRunning);
  records->disk_is_full = false;
  for (int i = 0; i < 6000 && stored() == BatchState::kRunning; ++i) std::this_thread::sleep_for(10ms);
  EXPECT_EQ(stored(), BatchState::kCompleted);
  const int writes = records->writes;
  std::this_thread::sleep_for(50ms);
  EXPECT_EQ(records->writes, writes) << "once is enough";
}

TEST_F(Runner, NothingLeavesForABatchThatIsNotStored) {
  limits.kept = 1;
  open();
  const auto first = submit(request(1));
  wait((*first)->id);
  records->disk_is_full = true;
  EXPECT_EQ(submit(request(2)).error().code, "storage_full");
  EXPECT_TRUE(get((*first)->id));
  EXPECT_EQ(records->all()->size(), 1U);
  records->disk_is_full = false;
  EXPECT_TRUE(submit(request(2)));
  EXPECT_EQ(get((*first)->id).error().code, "batch_not_found");
  EXPECT_EQ(records->all()->size(), 1U);
}

TEST_F(Runner, WhatWasActiveGoesOnAfterARestartThoughAPictureHasFailed) {
  BatchRequest batch = request(3, 1'000'000);
  batch.fail_fast = true;
  batch.max_active = 2;
  batch.items[1].request.scene = std::string(64, '3');
  const BatchId id = (*submit(batch))->id;
  const auto before = wait_until(id, [](const Batch& b) {
    return b.count(ItemState::kFailed) == 1 && b.count(ItemState::kSkipped) == 1 && !b.items()[0].job.empty();
  });
  open();
  const auto after = wait_until(id, [&](const Batch& b) { return b.revision > before->revision; });
  EXPECT_EQ(after->items()[0].state, ItemState::kActive);
  EXPECT_EQ(after->items()[0].job, before->items()[0].job);
  EXPECT_TRUE(answer_of<BatchPtr>([&](auto reply) { runner->cancel(id, reply); }));
  const auto end = wait(id);
  EXPECT_EQ(end->items()[0].state, ItemState::kCancelled);
  EXPECT_EQ(rig.get(before->items()[0].job)->state, JobState::kCancelled);
}

TEST_F(Runner, ItTakesNoClientsPlaceAndNeedsNone) {
  rig.scheduler.reset();
  rig.config.http.max_watchers = 1;
  runner.reset();
  rig.start();
  open();
  const auto watched = rig.submit(small_job(scene, 1'000'000));
  const auto client = answer_of<std::unique_ptr<Subscription>>([&](const auto& reply) {
    auto held = std::make_shared<std::decay_t<decltype(reply)>>(reply);
    rig.scheduler->watch(watched->job.id, [] {}, [held](auto result) { (*held)(std::move(result)); });
  });
  ASSERT_TRUE(client);
  EXPECT_EQ(wait((*submit(request(3)))->id)->count(ItemState::kCompleted), 3U);
}

TEST_F(Runner, ACancelOutlivesTheProcess) {
  const auto batch = submit(request(3, 1'000'000));
  ASSERT_TRUE(batch);
  wait_until((*batch)->id, [](const Batch& b) { return !b.items()[0].job.empty(); });
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
  ASSERT_TRUE(records->add({"b_bad", "rubbish", "more"}, {}));
  EXPECT_FALSE(records->add({"b_bad", "again", ""}, {})) << "an id is there once";
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
