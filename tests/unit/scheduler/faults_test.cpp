// Workers that fail, answer twice or too late: the picture stays what it is, and others are not troubled.
#include <gtest/gtest.h>

#include "support/faulty_executor.hpp"
#include "support/server_rig.hpp"
#include "support/temp_directory.hpp"

namespace raykiln::tests {
namespace {

using namespace server;

struct FaultyRig {
  explicit FaultyRig(std::function<Fault(const TileTask&)> choose)
      : rig(directory.path(), 2, {}, short_tasks()), executor(*rig.pool, std::move(choose)) {
    rig.scheduler.reset();
    rig.executor = &executor;
    rig.start();
    scene = rig.add_scene("a room")->scene.record.id;
  }
  ~FaultyRig() {
    executor.release();
    rig.scheduler.reset();
  }
  JobSnapshot run(std::uint64_t samples = 21) {
    id = rig.submit(small_job(scene, samples))->job.id;
    return rig.wait_final(id);
  }
  /// Of one tile and block each: many, however fast the machine is.
  static Config short_tasks() {
    Config config;
    config.scheduler.task_seconds_low = 5e-5;
    config.scheduler.task_seconds_target = 1e-4;
    config.scheduler.task_seconds_high = 2e-4;
    return config;
  }
  std::vector<float> picture() { return (*rig.image(id))->image.rgb; }

  TempDirectory directory;
  ServerRig rig;
  FaultyExecutor executor;
  std::string scene, id;
};

std::vector<float> undisturbed(std::uint64_t samples = 21) {
  FaultyRig plain([](const TileTask&) { return Fault::kNone; });
  EXPECT_EQ(plain.run(samples).state, JobState::kCompleted);
  return plain.picture();
}

/// Faults of every third item at its first attempt.
std::function<Fault(const TileTask&)> every_third(Fault fault, int& count) {
  return [fault, &count, n = 0](const TileTask& task) mutable {
    if (task.item.attempt > 1 || n++ % 3 != 0) return Fault::kNone;
    ++count;
    return fault;
  };
}

TEST(Faults, AFailedTaskIsRenderedAgain) {
  int faults = 0;
  FaultyRig faulty(every_third(Fault::kFail, faults));
  const auto last = faulty.run();
  EXPECT_EQ(last.state, JobState::kCompleted);
  EXPECT_GT(faults, 2);
  EXPECT_EQ(last.statistics.retried_tasks, static_cast<std::uint64_t>(faults));
  EXPECT_EQ(last.statistics.camera_rays, 96U * 64U * 21U) << "nothing is counted twice";
  EXPECT_EQ(faulty.picture(), undisturbed());
}

TEST(Faults, AResultThatComesTwiceIsMergedOnce) {
  int faults = 0;
  FaultyRig faulty(every_third(Fault::kTwice, faults));
  const auto last = faulty.run();
  EXPECT_EQ(last.state, JobState::kCompleted);
  EXPECT_GT(faults, 2);
  EXPECT_EQ(last.statistics.camera_rays, 96U * 64U * 21U);
  EXPECT_EQ(faulty.picture(), undisturbed());
  EXPECT_EQ(faulty.run().state, JobState::kCompleted) << "and the next job runs as ever";
}

TEST(Faults, AResultThatComesAfterItsRetryBeganChangesNothing) {
  int faults = 0;
  FaultyRig faulty(every_third(Fault::kFailThenDeliver, faults));
  const auto last = faulty.run();
  EXPECT_EQ(last.state, JobState::kCompleted);
  EXPECT_GT(faults, 2);
  EXPECT_EQ(last.statistics.camera_rays, 96U * 64U * 21U);
  EXPECT_EQ(faulty.picture(), undisturbed());
}

TEST(Faults, ATaskThatAlwaysFailsEndsItsJobWithTheReasonAndNoOther) {
  std::string doomed;
  std::mutex mutex;
  FaultyRig faulty([&](const TileTask& task) {
    const std::scoped_lock lock(mutex);
    const bool hit = task.job == doomed && task.item.first_block >= 1;
    return hit ? Fault::kFail : Fault::kNone;
  });
  {
    const std::scoped_lock lock(mutex);  // no task is chosen before its name is known
    doomed = faulty.rig.submit(small_job(faulty.scene, 64))->job.id;
  }
  const std::string other = faulty.rig.submit(small_job(faulty.scene, 64))->job.id;
  const auto failed = faulty.rig.wait_final(doomed);
  EXPECT_EQ(failed.state, JobState::kFailed);
  ASSERT_TRUE(failed.error);
  EXPECT_EQ(failed.error->code, "render_failed");
  EXPECT_NE(failed.error->message.find("injected fault (after 3 attempts)"), std::string::npos)
      << failed.error->message;
  EXPECT_TRUE(faulty.rig.image(doomed)) << "what was rendered before is kept";
  EXPECT_EQ(faulty.rig.wait_final(other).state, JobState::kCompleted);
}

TEST(Faults, AResultThatComesAfterTheCancelIsNotInThePicture) {
  FaultyRig faulty([](const TileTask& task) {
    return task.item.first_block >= 1 ? Fault::kHold : Fault::kNone;
  });
  const std::string id = faulty.rig.submit(small_job(faulty.scene, 64))->job.id;
  // Every tile has its first block now; what follows does not come.
  faulty.executor.wait_held(5);
  const auto before = faulty.rig.get(id);
  EXPECT_EQ(faulty.rig.cancel(id)->state, JobState::kCancelling);
  faulty.executor.release();
  const auto last = faulty.rig.wait_final(id);
  EXPECT_EQ(last.state, JobState::kCancelled);
  EXPECT_EQ(last.progress.samples_done, before->progress.samples_done);
  EXPECT_EQ(last.statistics.camera_rays, before->statistics.camera_rays);
  EXPECT_EQ((*faulty.rig.image(id))->samples_per_pixel, last.progress.samples_per_pixel);
}

}  // namespace
}  // namespace raykiln::tests
