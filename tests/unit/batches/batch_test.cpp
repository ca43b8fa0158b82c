// The rules of a batch, without anyone who runs it.
#include <gtest/gtest.h>

#include "raykiln/batches/batch.hpp"

namespace raykiln::server {
namespace {

Batch batch_of(std::size_t items, int max_active = 2, bool fail_fast = false) {
  BatchRequest request{.name = "n", .priority = 7, .max_active = max_active, .fail_fast = fail_fast};
  for (std::size_t i = 0; i < items; ++i) {
    BatchItem item;
    item.name = std::string("p").append(std::to_string(i));
    item.request.scene = std::string(64, 'a');
    item.request.seed = i;
    request.items.push_back(item);
  }
  return {"b_1", "key", std::move(request), WallTime(std::chrono::milliseconds(1'700'000'000'123))};
}

void start(Batch& batch) {
  const auto next = batch.next_to_start();
  ASSERT_TRUE(next);
  batch.enter(*next, ItemState::kActive);
}

TEST(Batch, ItsItemsTakeItsNamePriorityAndReuse) {
  const Batch batch = batch_of(2);
  EXPECT_EQ(batch.items()[1].request.name, "p1");
  EXPECT_EQ(batch.items()[1].request.priority, 7);
  EXPECT_TRUE(batch.items()[1].request.reuse);
}

TEST(Batch, StartsInOrderAndNoMoreThanItMay) {
  Batch batch = batch_of(4);
  EXPECT_EQ(batch.next_to_start(), 0U);
  start(batch);
  start(batch);
  EXPECT_FALSE(batch.next_to_start()) << "two are active";
  batch.enter(1, ItemState::kWaiting);
  EXPECT_EQ(batch.next_to_start(), 1U) << "there was no room for it";
  batch.enter(0, ItemState::kCompleted);
  start(batch);
  EXPECT_EQ(batch.next_to_start(), 2U);
}

TEST(Batch, EndsWhenNothingWaitsAndByTheGravest) {
  Batch batch = batch_of(3, 3);
  for (int i = 0; i < 3; ++i) start(batch);
  batch.enter(0, ItemState::kCompleted);
  batch.enter(1, ItemState::kCompleted);
  EXPECT_EQ(batch.state(), BatchState::kRunning);
  batch.enter(2, ItemState::kCompleted);
  EXPECT_EQ(batch.state(), BatchState::kCompleted);
  batch.enter(1, ItemState::kCancelled);
  EXPECT_EQ(batch.state(), BatchState::kCancelled);
  batch.enter(2, ItemState::kFailed);
  EXPECT_EQ(batch.state(), BatchState::kFailed);
}

TEST(Batch, FailFastSkipsWhatWaitsAndNothingElse) {
  Batch patient = batch_of(4), hasty = batch_of(4, 2, true);
  for (Batch* batch : {&patient, &hasty}) {
    start(*batch);
    start(*batch);
    batch->skip_after_failure();
    EXPECT_EQ(batch->count(ItemState::kSkipped), 0U);
    batch->enter(0, ItemState::kFailed);
    batch->skip_after_failure();
  }
  EXPECT_EQ(patient.count(ItemState::kWaiting), 2U);
  EXPECT_EQ(hasty.count(ItemState::kSkipped), 2U);
  EXPECT_EQ(hasty.count(ItemState::kActive), 1U);
  EXPECT_FALSE(hasty.next_to_start());
}

TEST(Batch, ARerunTriesAgainWhatDidNotComplete) {
  Batch batch = batch_of(4, 4);
  for (int i = 0; i < 3; ++i) start(batch);
  batch.enter(0, ItemState::kCompleted);
  batch.enter(1, ItemState::kFailed);
  batch.item(1).error = Error{ErrorKind::kInternal, "render_failed", "", ""};
  batch.enter(2, ItemState::kCancelled);
  batch.cancel_waiting();
  EXPECT_EQ(batch.rerun_failed(), 3U);
  EXPECT_EQ(batch.count(ItemState::kWaiting), 3U);
  EXPECT_EQ(batch.next_to_start(), 1U);
  EXPECT_EQ(batch.items()[0].attempt, 1);
  EXPECT_EQ(batch.items()[1].attempt, 2);
  EXPECT_FALSE(batch.items()[1].error);
}

TEST(Batch, ReadsBackFromItsRecords) {
  Batch batch = batch_of(4);
  start(batch);
  start(batch);
  batch.enter(0, ItemState::kFailed);
  batch.item(0).error = Error{ErrorKind::kNotFound, "scene_not_found", "why", "where"};
  batch.item(1).job = "j_1";
  batch.enter(2, ItemState::kCompleted);
  batch.mark_reused(2);
  batch.revision = 9;
  batch.cancelled = true;
  const auto back = decode_batch(encode_batch_request(batch), encode_batch_state(batch));
  ASSERT_TRUE(back);
  EXPECT_EQ(batch_digest(back->request()), batch_digest(batch.request()));
  EXPECT_EQ(back->id, "b_1");
  EXPECT_EQ(back->idempotency_key, "key");
  EXPECT_EQ(back->created, batch.created);
  EXPECT_EQ(back->revision, 9U);
  EXPECT_TRUE(back->cancelled);
  EXPECT_FALSE(back->finished);
  EXPECT_EQ(back->items()[0].error->code, "scene_not_found");
  EXPECT_EQ(back->items()[1].state, ItemState::kActive) << "its job goes on";
  EXPECT_EQ(back->items()[1].job, "j_1");
  EXPECT_EQ(back->count(ItemState::kWaiting), 1U);
  EXPECT_EQ(back->reused(), 1U);
  EXPECT_FALSE(decode_batch("rubbish", encode_batch_state(batch)));
  EXPECT_FALSE(decode_batch(encode_batch_request(batch), encode_batch_state(batch_of(3))));
}

TEST(Batch, ASummaryKeepsTheCounts) {
  Batch batch = batch_of(3);
  start(batch);
  batch.enter(0, ItemState::kCompleted);
  const Batch summary = batch.without_items();
  EXPECT_TRUE(summary.items().empty());
  EXPECT_EQ(summary.total(), 3U);
  EXPECT_EQ(summary.count(ItemState::kCompleted), 1U);
  EXPECT_EQ(summary.state(), BatchState::kRunning);
}

TEST(BatchDigest, TellsBatchesApart) {
  const std::string one = batch_digest(batch_of(2).request());
  EXPECT_EQ(batch_digest(batch_of(2).request()), one);
  EXPECT_NE(batch_digest(batch_of(3).request()), one);
  EXPECT_NE(batch_digest(batch_of(2, 3).request()), one);
  EXPECT_NE(batch_digest(batch_of(2, 2, true).request()), one);
}

}  // namespace
}  // namespace raykiln::server
