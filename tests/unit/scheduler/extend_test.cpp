// Jobs that go on from the samples of completed ones.
#include <gtest/gtest.h>

#include <algorithm>

#include "support/server_rig.hpp"
#include "support/temp_directory.hpp"

namespace raykiln::tests {
namespace {

using namespace server;

class Extend : public ::testing::Test {
 protected:
  JobSnapshot ended(const Result<SubmittedJob>& submitted) {
    EXPECT_TRUE(submitted) << submitted.error().message;
    JobSnapshot job = rig_.wait_final(submitted->job.id);
    EXPECT_EQ(job.state, JobState::kCompleted);
    return job;
  }
  JobSnapshot rendered(const StopRule& stop, int tile = 16) {
    JobRequest request = small_job(scene_);
    request.layers = "albedo,depth,object_id,direct,indirect";
    request.stop = stop;
    request.tile = tile;
    return ended(rig_.submit(request));
  }
  Result<SubmittedJob> ask(const JobId& job, const StopRule& stop, const std::string& key = "") {
    ExtendJob extension;
    extension.job = job;
    extension.stop = stop;
    extension.idempotency_key = key;
    return answer_of<SubmittedJob>([&](auto reply) { rig_.scheduler->extend(extension, reply); });
  }
  JobSnapshot extended(const JobId& job, const StopRule& stop) { return ended(ask(job, stop)); }
  /// Picture, errors, samples and what else is asked for.
  std::vector<float> layers(const JobId& id) {
    const auto image = answer_of<JobImagePtr>([&](auto reply) { rig_.scheduler->image(id, "all", reply); });
    std::vector<float> all = (*image)->image.rgb;
    all.insert(all.end(), (*image)->error.begin(), (*image)->error.end());
    all.insert(all.end(), (*image)->samples.begin(), (*image)->samples.end());
    EXPECT_EQ((*image)->layers.size(), 5U);
    for (const StoredLayer& layer : (*image)->layers) all.insert(all.end(), layer.values.begin(), layer.values.end());
    return all;
  }

  TempDirectory directory_;
  ServerRig rig_{directory_.path(), 3};
  std::string scene_ = rig_.add_scene("a room")->scene.record.id;
};

// 50 and 99 end within a block of 16, 3 within one of 2: these are rendered anew.
TEST_F(Extend, GivesThePictureThatAllSamplesAtOnceWouldHaveGiven) {
  const auto whole = layers(rendered({.samples = 100}).id);
  for (const auto& [first, kept] : {std::pair{1U, 1.0}, {3U, 2.0}, {50U, 48.0}, {64U, 64.0}, {99U, 96.0}}) {
    const JobSnapshot early = rendered({.samples = first});
    const JobSnapshot late = extended(early.id, {.samples = 100});
    EXPECT_EQ(late.continues, early.id);
    EXPECT_EQ(late.continued_samples, kept);
    EXPECT_EQ(late.progress.samples_done, late.progress.samples_target);
    EXPECT_GT(late.statistics.render_seconds, early.statistics.render_seconds);
    EXPECT_EQ(layers(late.id), whole) << first;
  }
}

TEST_F(Extend, CostsOnlyTheNewSamples) {
  const JobSnapshot early = rendered({.samples = 64});
  const JobSnapshot late = extended(early.id, {.samples = 128});
  const auto pixels = std::uint64_t{96} * 64;
  EXPECT_EQ(early.statistics.paths, 64 * pixels);
  EXPECT_EQ(late.statistics.paths, 128 * pixels);  // those of both, none twice
}

TEST_F(Extend, InSeveralStepsToo) {
  JobSnapshot job = rendered({.samples = 5});
  for (const std::uint64_t more : {17U, 40U, 41U, 90U}) job = extended(job.id, {.samples = more});
  EXPECT_EQ(layers(job.id), layers(rendered({.samples = 90}).id));
}

TEST_F(Extend, BeginsAnewWithTheSamePictureWhenTheFilmIsGone) {
  const JobSnapshot early = rendered({.samples = 20});
  const JobSnapshot first = extended(early.id, {.samples = 40});
  const JobSnapshot second = extended(early.id, {.samples = 40});
  EXPECT_EQ(first.continued_samples, 16.0);
  EXPECT_EQ(second.continued_samples, 0.0);
  EXPECT_EQ(second.continues, early.id);
  EXPECT_EQ(layers(second.id), layers(first.id));
}

// Tiles that time has ended at different samples catch up.
TEST_F(Extend, OfATimedJobIsWholeAgain) {
  JobSnapshot timed;
  for (double seconds = 0.2; seconds < 60.0 && timed.progress.samples_per_pixel < 32.0; seconds *= 4.0) {  // of a busy machine
    timed = rendered({.samples = 1'000'000, .seconds = seconds}, 8);
  }
  std::uint64_t most = static_cast<std::uint64_t>(timed.progress.samples_per_pixel);
  for (const std::uint64_t samples : timed.tile_samples) most = std::max(most, samples);
  most += 100;
  const JobSnapshot late = extended(timed.id, {.samples = most});
  EXPECT_GT(late.continued_samples, 0.0);
  EXPECT_EQ(layers(late.id), layers(rendered({.samples = most}, 8).id));
}

// The tile that has most counts, not the mean.
TEST_F(Extend, OfTilesThatDifferNeedsMoreThanTheMost) {
  StopRule tiles{.samples = 64};
  tiles.tile_samples.assign(24, 16);
  tiles.tile_samples[5] = 64;
  const JobSnapshot early = rendered(tiles);
  EXPECT_EQ(ask(early.id, {.samples = 48}).error().where, "/stop/samples");
  EXPECT_EQ(layers(extended(early.id, {.samples = 80}).id), layers(rendered({.samples = 80}).id));
}

TEST_F(Extend, ToAnErrorDecidesWhereAWholeJobWouldHaveDecided) {
  const StopRule target{.samples = 100'000, .error = 0.04};
  const JobSnapshot whole = rendered(target);
  const JobSnapshot late = extended(rendered({.samples = 70}).id, target);
  EXPECT_EQ(late.done_by, DoneBy::kError);
  EXPECT_EQ(late.progress.samples_per_pixel, whole.progress.samples_per_pixel);
  EXPECT_EQ(layers(late.id), layers(whole.id));
}

TEST_F(Extend, ToWhatIsReachedAlreadyEndsAtOnce) {
  const JobSnapshot early = rendered({.samples = 256});
  const JobSnapshot late = extended(early.id, {.samples = 100'000, .error = 1.0});
  EXPECT_EQ(late.done_by, DoneBy::kError);
  EXPECT_EQ(late.progress.samples_per_pixel, 256.0);
}

// Their film is made, and what they go on from is read, on the thread of the disk.
TEST_F(Extend, OfLargeFilmsGivesTheSamePicture) {
  const auto whole = layers(rendered({.samples = 40}).id);
  rig_.scheduler.reset();
  rig_.judged_at_once_px = 0;
  rig_.start();
  const JobSnapshot late = extended(rendered({.samples = 20}).id, {.samples = 40});
  EXPECT_EQ(late.continued_samples, 16.0);
  EXPECT_EQ(layers(late.id), whole);
  // One that is cancelled before it has a film ends, and so does what comes after it.
  const auto cancelled = rig_.submit(small_job(scene_, 1'000'000));
  (void)rig_.cancel(cancelled->job.id);
  EXPECT_EQ(rig_.wait_final(cancelled->job.id).state, JobState::kCancelled);
  EXPECT_EQ(layers(rendered({.samples = 40}).id), whole);
}

TEST_F(Extend, IsRefusedWhereItAddsNothing) {
  const JobSnapshot early = rendered({.samples = 20});
  EXPECT_EQ(ask(early.id, {.samples = 20}).error().where, "/stop/samples");
  EXPECT_EQ(ask("j_none", {.samples = 40}).error().code, "job_not_found");
  JobRequest request = small_job(scene_, 1'000'000);
  const auto endless = rig_.submit(request);
  EXPECT_EQ(ask(endless->job.id, {.samples = 1'048'576}).error().code, "job_not_completed");
  (void)rig_.cancel(endless->job.id);
  (void)rig_.wait_final(endless->job.id);
  EXPECT_EQ(ask(endless->job.id, {.samples = 1'048'576}).error().code, "job_not_completed");
}

TEST_F(Extend, IsAskedForOnceByItsKey) {
  const JobSnapshot early = rendered({.samples = 4}), other = rendered({.samples = 4});
  const auto first = ask(early.id, {.samples = 8}, "key"), again = ask(early.id, {.samples = 8}, "key");
  ASSERT_TRUE(first && again);
  EXPECT_EQ(first->job.id, again->job.id);
  EXPECT_FALSE(again->created);
  EXPECT_EQ(ask(other.id, {.samples = 8}, "key").error().code, "idempotency_key_reused");
  (void)rig_.wait_final(first->job.id);
}

TEST_F(Extend, KeepsFilmsWithinTheirBound) {
  const TempDirectory directory;
  Config config;
  config.scheduler.max_kept_film_bytes = 1;
  ServerRig rig(directory.path(), 2, {}, config);
  JobRequest request = small_job(rig.add_scene("a room")->scene.record.id, 4);
  const JobSnapshot early = rig.wait_final(rig.submit(request)->job.id);
  ExtendJob extension;
  extension.job = early.id;
  extension.stop.samples = 8;
  const auto submitted = answer_of<SubmittedJob>([&](auto reply) { rig.scheduler->extend(extension, reply); });
  const JobSnapshot late = rig.wait_final(submitted->job.id);
  EXPECT_EQ(late.state, JobState::kCompleted);
  EXPECT_EQ(late.continued_samples, 0.0);
}

}  // namespace
}  // namespace raykiln::tests
