// One tree for all who wait for it, and none for nobody.
#include <gtest/gtest.h>

#include <latch>

#include "raykiln/workers/scene_tree.hpp"
#include "support/server_rig.hpp"
#include "support/temp_directory.hpp"

namespace raykiln::tests {
namespace {

using namespace server;

double builds(ServerRig& rig) {
  return rig.metrics.counter("raykiln_tree_builds_total", "").value();
}

TEST(BuildOnce, AnotherMaterialOrCameraDoesNotRebuild) {
  const TempDirectory directory;
  ServerRig rig(directory.path());
  rig.intake.make = [](const BlobFile& file) {
    return tiny_scene(0.1F * static_cast<float>(file.bytes), 2.0F);
  };
  for (const char* bytes : {"a", "bb", "ccc"}) {
    auto request = small_job(rig.add_scene(bytes)->scene.record.id);
    EXPECT_EQ(rig.wait_final(rig.submit(request)->job.id).state, JobState::kCompleted);
    request.camera = OwnCamera{{0.0, 1.0, 4.0}, {0.0, 0.5, 0.0}, {0.0, 1.0, 0.0}, 50.0};
    EXPECT_EQ(rig.wait_final(rig.submit(request)->job.id).state, JobState::kCompleted);
  }
  EXPECT_EQ(builds(rig), 1.0);
}

/// A builder that waits until it is let go or told to stop.
struct HeldBuilder {
  std::atomic<bool> released{false};
  std::atomic<int> begun{0}, stopped{0};
  TreeBuilder builder() {
    return [this](const render::Scene& scene, const TreeBudget& budget, render::TaskRunner& runner) {
      ++begun;
      while (!released && !runner.stop_requested()) std::this_thread::yield();
      if (runner.stop_requested()) {
        ++stopped;
        return std::shared_ptr<const render::KdTree>();
      }
      return build_tree(scene, budget, runner);
    };
  }
  void wait_begun(int n) const {
    while (begun < n) std::this_thread::yield();
  }
};

TEST(BuildOnce, CancelWhilePreparingIsImmediateAndOthersKeepTheBuild) {
  const TempDirectory directory;
  HeldBuilder held;
  ServerRig rig(directory.path(), 2, held.builder());
  const auto scene = rig.add_scene("a room")->scene.record.id;
  const auto first = rig.submit(small_job(scene))->job.id;
  const auto second = rig.submit(small_job(scene))->job.id;
  held.wait_begun(1);
  rig.follow(second, [](const auto& s) { return s.state == JobState::kPreparing; });
  EXPECT_EQ(rig.cancel(first)->state, JobState::kCancelled);
  EXPECT_EQ(rig.get(second)->state, JobState::kPreparing);
  held.released = true;
  EXPECT_EQ(rig.wait_final(second).state, JobState::kCompleted);
  EXPECT_EQ(builds(rig), 1.0);
  EXPECT_EQ(held.stopped, 0);
}

TEST(BuildOnce, ABuildThatNobodyWaitsForStops) {
  const TempDirectory directory;
  HeldBuilder held;
  ServerRig rig(directory.path(), 2, held.builder());
  const auto scene = rig.add_scene("a room")->scene.record.id;
  const auto job = rig.submit(small_job(scene))->job.id;
  held.wait_begun(1);
  EXPECT_EQ(rig.cancel(job)->state, JobState::kCancelled);
  while (held.stopped == 0) std::this_thread::yield();
  EXPECT_EQ(builds(rig), 0.0);
  held.released = true;
  EXPECT_EQ(rig.wait_final(rig.submit(small_job(scene))->job.id).state, JobState::kCompleted);
  EXPECT_EQ(builds(rig), 1.0);
}

TEST(BuildOnce, TwoScenesOfTheSameGeometryShareABuildInFlight) {
  const TempDirectory directory;
  HeldBuilder held;
  ServerRig rig(directory.path(), 2, held.builder());
  rig.intake.make = [](const BlobFile& file) {
    return tiny_scene(0.1F * static_cast<float>(file.bytes), 2.0F);
  };
  const auto one = rig.submit(small_job(rig.add_scene("a")->scene.record.id))->job.id;
  const auto two = rig.submit(small_job(rig.add_scene("bb")->scene.record.id))->job.id;
  held.wait_begun(1);
  held.released = true;
  EXPECT_EQ(rig.wait_final(one).state, JobState::kCompleted);
  EXPECT_EQ(rig.wait_final(two).state, JobState::kCompleted);
  EXPECT_EQ(builds(rig), 1.0);
}

}  // namespace
}  // namespace raykiln::tests
