// What ends a job: samples, time or error.
#include <gtest/gtest.h>

#include <algorithm>
#include <future>

#include "support/server_rig.hpp"
#include "support/temp_directory.hpp"

namespace raykiln::tests {
namespace {

using namespace server;

struct Ended {
  JobSnapshot job;
  std::vector<float> rgb;
};

Ended run(int threads, const std::function<void(JobRequest&)>& change, int judged_at_once_px = 65'536,
          Config config = {}) {
  const TempDirectory directory;
  ServerRig rig(directory.path(), threads, {}, std::move(config));
  rig.scheduler.reset();
  rig.judged_at_once_px = judged_at_once_px;
  rig.start();
  JobRequest request = small_job(rig.add_scene("a room")->scene.record.id);
  change(request);
  const auto submitted = rig.submit(request);
  EXPECT_TRUE(submitted) << submitted.error().message;
  Ended ended{rig.wait_final(submitted->job.id), {}};
  EXPECT_EQ(ended.job.state, JobState::kCompleted);
  ended.rgb = (*rig.image(submitted->job.id))->image.rgb;
  return ended;
}

TEST(Stops, ByErrorHoldTheTargetAndDoNotDependOnThreads) {
  const auto by_error = [](JobRequest& r) {
    r.stop.samples = 100'000;
    r.stop.error = 0.02;
    r.width = r.height = 48;
    r.tile = 16;
  };
  const Ended one = run(1, by_error), many = run(5, by_error);
  ASSERT_TRUE(one.job.accuracy);
  EXPECT_EQ(one.job.done_by, DoneBy::kError);
  EXPECT_LE(one.job.accuracy->error.high, 0.02);
  EXPECT_GT(one.job.accuracy->error.value, 0.012) << "stopped much too late";
  EXPECT_GE(one.job.accuracy->least_samples, kErrorFloor);
  EXPECT_DOUBLE_EQ(one.job.progress.fraction(), 1.0);
  EXPECT_FALSE(one.job.curve.empty());
  EXPECT_EQ(many.job.accuracy->least_samples, one.job.accuracy->least_samples);
  EXPECT_EQ(many.job.accuracy->error.value, one.job.accuracy->error.value);
  EXPECT_EQ(many.rgb, one.rgb);
  const Ended stated = run(2, [&](JobRequest& r) {
    by_error(r);
    r.stop = {.samples = one.job.accuracy->least_samples};
  });
  EXPECT_EQ(stated.job.done_by, DoneBy::kSamples);
  EXPECT_EQ(stated.rgb, one.rgb);
}

TEST(Stops, LargeFilmsAreJudgedElsewhereWithTheSameEnd) {
  const auto by_error = [](JobRequest& r) {
    r.stop = {.samples = 100'000, .error = 0.02};
    r.width = r.height = 48;
  };
  const Ended here = run(2, by_error), elsewhere = run(2, by_error, 0);
  EXPECT_EQ(elsewhere.job.done_by, DoneBy::kError);
  EXPECT_EQ(elsewhere.job.accuracy->error.value, here.job.accuracy->error.value);
  EXPECT_EQ(elsewhere.job.accuracy->least_samples, here.job.accuracy->least_samples);
  EXPECT_EQ(elsewhere.rgb, here.rgb);
  EXPECT_GT(elsewhere.job.statistics.accuracy_seconds, 0.0);
  // The time ends while a decision is being made, or between two.
  const Ended timed = run(2, [](JobRequest& r) { r.stop = {.samples = 1'000'000, .seconds = 0.3, .error = 0.0001}; }, 0);
  EXPECT_EQ(timed.job.done_by, DoneBy::kSeconds);
  EXPECT_FALSE(target_met(timed.job.request.stop, *timed.job.accuracy));
}

TEST(Stops, ByTimeEndAtBordersAndAreMadeAgainFromTheirSamples) {
  const Ended timed = run(3, [](JobRequest& r) {
    r.stop.samples = 1'000'000;
    r.stop.seconds = 0.3;
    r.tile = 8;
  });
  EXPECT_EQ(timed.job.done_by, DoneBy::kSeconds);
  EXPECT_GE(timed.job.statistics.render_seconds, 0.3);
  EXPECT_DOUBLE_EQ(timed.job.progress.fraction(), 1.0);
  std::vector<std::uint64_t> samples = timed.job.tile_samples;
  if (samples.empty()) samples.assign(96, static_cast<std::uint64_t>(timed.job.progress.samples_per_pixel));
  ASSERT_EQ(samples.size(), 96U);
  const Ended again = run(1, [&](JobRequest& r) {
    r.tile = 8;
    r.stop.samples = *std::max_element(samples.begin(), samples.end());
    r.stop.tile_samples = samples;
  });
  EXPECT_EQ(again.rgb, timed.rgb);
  EXPECT_EQ(again.job.progress.samples_done, timed.job.progress.samples_done);
}

TEST(Stops, ATargetOutOfReachEndsByTimeAndSaysSo) {
  const Ended ended = run(2, [](JobRequest& r) {
    r.stop.samples = 1'000'000;
    r.stop.seconds = 0.4;
    r.stop.error = 0.0001;
  });
  EXPECT_EQ(ended.job.done_by, DoneBy::kSeconds);
  EXPECT_FALSE(target_met(ended.job.request.stop, *ended.job.accuracy));
}

/// Made strip by strip while samples come in.
void expect_error_layers(const JobImage& image) {
  EXPECT_FALSE(image.is_final);
  ASSERT_EQ(image.image.rgb.size(), std::size_t{3} * 160 * 120);
  ASSERT_EQ(image.error.size(), image.image.rgb.size());
  ASSERT_EQ(image.samples.size(), std::size_t{160} * 120);
  ASSERT_EQ(image.seconds.size(), image.samples.size());
  EXPECT_GE(*std::min_element(image.samples.begin(), image.samples.end()), 1.0F);
  EXPECT_GT(*std::min_element(image.seconds.begin(), image.seconds.end()), 0.0F);
  std::size_t wrong = 0;  // an error is known from two samples on
  for (std::size_t i = 0; i < image.error.size(); ++i) wrong += (image.error[i] >= 0.0F) == (image.samples[i / 3] >= 2.0F) ? 0U : 1U;
  EXPECT_EQ(wrong, 0U);
  EXPECT_GT(*std::min_element(image.image.rgb.begin(), image.image.rgb.end()), 0.0F) << "every row is there";
}

TEST(Stops, LargePicturesAreLookedAtOnASampleAndJudgedInFullInTheEnd) {
  const TempDirectory directory;
  Config config;
  config.scheduler.look_share = 1.0;
  ServerRig rig(directory.path(), 2, {}, config);
  JobRequest request = small_job(rig.add_scene("a room")->scene.record.id, 32);
  request.width = 160;
  request.height = 120;
  const auto sampled = [](const JobSnapshot& s) {
    return s.accuracy && std::count(s.accuracy->notices.begin(), s.accuracy->notices.end(), "error_sampled") > 0;
  };
  EXPECT_FALSE(sampled(rig.wait_final(rig.submit(request)->job.id)));
  // However busy the machine is, a job without an end is looked at before it ends.
  request.stop.samples = 1'000'000;
  const std::string looked_at = rig.submit(request)->job.id;
  rig.follow(looked_at, sampled);
  (void)rig.cancel(looked_at);
  rig.wait_final(looked_at);
  // Who cancels a large picture gets a look at what it has by then.
  rig.scheduler.reset();
  rig.judged_at_once_px = 0;
  rig.config.scheduler.look_share = 0.0;
  rig.start();
  const std::string id = rig.submit(request)->job.id;
  rig.follow(id, [](const JobSnapshot& s) { return s.progress.samples_per_pixel >= 4.0; });
  const auto running = answer_of<JobImagePtr>([&](auto reply) { rig.scheduler->image(id, "all", reply); });
  ASSERT_TRUE(running);
  expect_error_layers(**running);
  (void)rig.cancel(id);
  const JobSnapshot cancelled = rig.wait_final(id);
  EXPECT_TRUE(sampled(cancelled));
  EXPECT_GE(cancelled.accuracy->mean_samples, 4.0);
  // Its picture is there at once, its layers when they are stored.
  const auto image = rig.image(id);
  ASSERT_TRUE(image);
  EXPECT_EQ((*image)->revision, cancelled.revision);
  const auto all = answer_of<JobImagePtr>([&](auto reply) { rig.scheduler->image(id, "all", reply); });
  ASSERT_TRUE(all);
  EXPECT_TRUE((*all)->is_final);
  EXPECT_EQ((*all)->image.rgb, (*image)->image.rgb);
  EXPECT_EQ((*all)->samples.size(), std::size_t{160} * 120);
  EXPECT_EQ((*all)->error.size(), 3 * (*all)->samples.size());
}

/// Sums of what every pixel's light is made of: the picture itself, if all of a pixel is of the same samples.
void expect_parts_of_light(const JobImage& image) {
  ASSERT_EQ(image.layers.size(), 4U);
  EXPECT_EQ(image.layers[0].name, "depth");
  EXPECT_EQ(image.layers[0].values.size(), image.samples.size());
  for (std::size_t i = 0; i < image.image.rgb.size(); ++i) {
    const float sum = image.layers[1].values.at(i) + image.layers[2].values.at(i) + image.layers[3].values.at(i);
    ASSERT_NEAR(sum, image.image.rgb[i], 1e-5F * (1.0F + sum)) << i;
  }
}

// Layers of a large picture come strip by strip, those that the job asks for too; who is one too many is told so.
TEST(Stops, LayersOfALargePictureAreGatheredForABoundedNumber) {
  const TempDirectory directory;
  ServerRig rig(directory.path());
  rig.scheduler.reset();
  rig.judged_at_once_px = 1000;  // strips of 6 rows
  rig.start();
  JobRequest request = small_job(rig.add_scene("a room")->scene.record.id, 1'000'000);
  request.width = 160;
  request.height = 120;
  request.layers = "depth,emission,direct,indirect";
  const std::string id = rig.submit(request)->job.id;
  rig.follow(id, [](const JobSnapshot& s) { return s.progress.samples_per_pixel >= 4.0; });
  // The strand is held up until all have asked, so that none of them finds the layers made.
  std::promise<void> all_asked;
  rig.scheduler->status([asked = all_asked.get_future().share()](const auto&) { asked.wait(); });
  constexpr int kAsking = 100, kMostWaiting = 64;
  std::vector<std::promise<Result<JobImagePtr>>> answers(kAsking);
  for (auto& answer : answers) {
    rig.scheduler->image(id, "all", [&answer](Result<JobImagePtr> image) { answer.set_value(std::move(image)); });
  }
  all_asked.set_value();
  int refused = 0;
  for (auto& answer : answers) {
    const auto image = answer.get_future().get();
    if (!image) {
      ++refused;
      EXPECT_EQ(image.error().code, "image_not_ready");
      EXPECT_EQ(image.error().retry_after_s, 1);
      continue;
    }
    expect_error_layers(**image);
    if (&answer == &answers.front()) expect_parts_of_light(**image);
  }
  EXPECT_EQ(refused, kAsking - kMostWaiting);
  (void)rig.cancel(id);
  rig.wait_final(id);
  const auto stored = answer_of<JobImagePtr>([&](auto reply) { rig.scheduler->image(id, "all", reply); });
  ASSERT_TRUE(stored);
  expect_parts_of_light(**stored);
}

/// The record of a job that was cancelled while the store had no room for its picture.
JobSnapshot cancelled_without_room(int judged_at_once_px) {
  const TempDirectory directory;
  Config config;
  config.store.max_bytes = 300'000;
  ServerRig rig(directory.path(), 2, {}, config);
  rig.scheduler.reset();
  rig.judged_at_once_px = judged_at_once_px;
  rig.start();
  JobRequest request = small_job(rig.add_scene("a room")->scene.record.id, 1'000'000);
  request.width = 160;
  request.height = 120;  // 600 kB in the store
  const std::string id = rig.submit(request)->job.id;
  rig.follow(id, [](const JobSnapshot& s) { return s.progress.samples_per_pixel >= 1.0; });
  (void)rig.cancel(id);
  EXPECT_EQ(rig.wait_final(id).state, JobState::kCancelled);
  EXPECT_FALSE(answer_of<JobImagePtr>([&](auto reply) { rig.scheduler->image(id, "all", reply); }));
  EXPECT_EQ(rig.image(id).error().code, "image_not_ready");
  EXPECT_FALSE(rig.image(id).error().retry_after_s) << "it will never be there";
  return *rig.get(id);
}

// The final state of a large one comes before the store has its picture: should that fail, the record does not go on
// naming it. Whoever looks for the picture is told why it is gone.
TEST(Stops, AFullStoreTakesThePictureOfACancelledJobAndSaysSo) {
  for (const int judged_at_once_px : {0, 65'536}) {
    const JobSnapshot after = cancelled_without_room(judged_at_once_px);
    EXPECT_EQ(after.image_revision, 0U);
    EXPECT_GT(after.progress.samples_done, 0U);
    ASSERT_FALSE(after.warnings.empty());
    EXPECT_EQ(after.warnings.back().code, "image_not_stored");
    EXPECT_EQ(after.warnings.back().message, "the picture could not be stored and is lost: the store has no room for the picture");
    EXPECT_EQ(std::count_if(after.warnings.begin(), after.warnings.end(),
                            [](const JobWarning& w) { return w.code == "image_not_stored"; }), 1);
  }
}

TEST(Stops, AdaptiveJobsDoNotDependOnThreadsAndAreMadeAgainFromTheirSamples) {
  const auto adaptive = [](JobRequest& r) {
    r.stop = {.samples = 4096, .error = 0.03};
    r.width = 72;
    r.height = 56;
    r.adaptive = true;
    r.tile = kAdaptiveTile;
  };
  const Ended one = run(1, adaptive), many = run(4, adaptive, 0);
  EXPECT_EQ(one.job.done_by, DoneBy::kError);
  EXPECT_LE(one.job.accuracy->error.high, 0.03);
  EXPECT_GE(one.job.accuracy->least_samples, kErrorFloor);
  EXPECT_EQ(one.job.accuracy->notices.back(), "adaptive");
  EXPECT_EQ(many.rgb, one.rgb);
  EXPECT_EQ(many.job.tile_samples, one.job.tile_samples);
  ASSERT_EQ(one.job.tile_samples.size(), 20U) << "no cell has more than another";
  const Ended again = run(3, [&](JobRequest& r) {
    adaptive(r);
    r.adaptive = false;
    const auto& samples = one.job.tile_samples;
    r.stop = {.samples = *std::max_element(samples.begin(), samples.end()), .tile_samples = samples};
  });
  EXPECT_EQ(again.rgb, one.rgb);
  // By time: what was begun ends at borders, and says so.
  const Ended timed = run(2, [&](JobRequest& r) {
    adaptive(r);
    r.stop = {.samples = 1'000'000, .seconds = 0.4};
  });
  EXPECT_EQ(timed.job.done_by, DoneBy::kSeconds);
  EXPECT_EQ(timed.job.accuracy->notices.back(), "adaptive");
  // All samples that there may be end it, too.
  const Ended full = run(2, [&](JobRequest& r) {
    adaptive(r);
    r.stop = {.samples = 96, .error = 0.0001};
  });
  EXPECT_EQ(full.job.done_by, DoneBy::kSamples);
  EXPECT_TRUE(full.job.tile_samples.empty());
}

TEST(Stops, EveryJobKnowsItsError) {
  const Ended ended = run(2, [](JobRequest& r) { r.stop.samples = 64; });
  ASSERT_TRUE(ended.job.accuracy);
  EXPECT_EQ(ended.job.accuracy->grade, "measured");
  EXPECT_GT(ended.job.accuracy->error.value, 0.0);
  ASSERT_FALSE(ended.job.curve.empty());
  EXPECT_EQ(ended.job.curve.back().samples, 64.0);
  EXPECT_EQ(ended.job.curve.back().rays, ended.job.statistics.rays());
}

TEST(Stops, WithoutLooksTheErrorIsJudgedInTheEndAlone) {
  const auto many_samples = [](JobRequest& r) { r.stop.samples = 1024; };
  // A look may take as long as what was rendered since the one before: by the usual share, one that a busy machine
  // interrupts may be the only one, and comes before an error is known.
  Config blind, looking;
  blind.scheduler.look_share = 0.0;
  looking.scheduler.look_share = 1.0;
  const Ended ended = run(2, many_samples, 65'536, blind), looked = run(2, many_samples, 65'536, looking);
  EXPECT_EQ(ended.job.curve.size(), 1U);
  EXPECT_GT(looked.job.curve.size(), 1U);
  ASSERT_TRUE(ended.job.accuracy);
  EXPECT_EQ(ended.job.accuracy->error.value, looked.job.accuracy->error.value);
  EXPECT_EQ(ended.rgb, looked.rgb);
}

}  // namespace
}  // namespace raykiln::tests
