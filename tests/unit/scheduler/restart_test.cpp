// What a process leaves behind, and what the next one makes of it.
#include <gtest/gtest.h>

#include "support/server_rig.hpp"
#include "support/temp_directory.hpp"

namespace raykiln::tests {
namespace {

using namespace server;

TEST(Restart, UnfinishedJobsRunAgainAndFinishedOnesStay) {
  const TempDirectory directory;
  std::string done, running;
  std::vector<float> picture;
  JobSnapshot before;
  {
    ServerRig rig(directory.path());
    const auto scene = rig.add_scene("a room")->scene.record.id;
    done = rig.submit(small_job(scene))->job.id;
    before = rig.wait_final(done);
    picture = (*rig.image(done))->image.rgb;
    running = rig.submit(small_job(scene, 50'000))->job.id;
    rig.follow(running, [](const auto& s) { return s.state == JobState::kRendering; });
    rig.scheduler->shutdown(0ms);
    EXPECT_EQ(rig.get(running).error().code, "shutting_down");
  }
  ServerRig rig(directory.path());
  const auto after = rig.get(done);
  ASSERT_TRUE(after);
  EXPECT_EQ(after->state, JobState::kCompleted);
  EXPECT_EQ(after->revision, before.revision);
  EXPECT_EQ(after->statistics.camera_rays, before.statistics.camera_rays);
  EXPECT_EQ((*rig.image(done))->image.rgb, picture);
  const auto again =
      rig.follow(running, [](const auto& s) { return s.state == JobState::kRendering; });
  EXPECT_GT(again.revision, 3U) << "revisions never go back";
  EXPECT_TRUE(rig.cancel(running));
  EXPECT_EQ(rig.wait_final(running).state, JobState::kCancelled);
}

TEST(Restart, LayersStayAndPartialOnesAreThere) {
  const TempDirectory directory;
  JobRequest request;
  std::string done;
  std::vector<StoredLayer> before;
  const auto layers_of = [](ServerRig& rig, const std::string& id) {
    const auto image = answer_of<JobImagePtr>([&](auto reply) { rig.scheduler->image(id, "all", reply); });
    return image ? (*image)->layers : std::vector<StoredLayer>{};
  };
  {
    ServerRig rig(directory.path());
    request = small_job(rig.add_scene("a room")->scene.record.id);
    request.layers = "normal,depth,emission";
    done = rig.submit(request)->job.id;
    EXPECT_EQ(rig.wait_final(done).state, JobState::kCompleted);
    before = layers_of(rig, done);
    ASSERT_EQ(before.size(), 3U);
    EXPECT_EQ(before[0].name, "normal");
    EXPECT_EQ(before[1].values.size(), 96U * 64U);
    JobRequest endless = request;
    endless.stop.samples = 1'000'000;
    const auto running = rig.submit(endless)->job.id;
    rig.follow(running, [](const auto& s) { return s.image_revision > 0; });
    EXPECT_EQ(layers_of(rig, running).size(), 3U) << "while it is rendered";
    (void)rig.cancel(running);
    (void)rig.wait_final(running);
    EXPECT_EQ(layers_of(rig, running).size(), 3U) << "of the partial picture";
  }
  ServerRig rig(directory.path());
  const auto after = layers_of(rig, done);
  ASSERT_EQ(after.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(after[i].values, before[i].values) << before[i].name;
  const std::string again = rig.submit(request)->job.id;
  rig.wait_final(again);
  EXPECT_EQ(layers_of(rig, again)[1].values, before[1].values);
}

TEST(Restart, ResultsAreReusedByTheSameEngineAlone) {
  const TempDirectory directory;
  Config config;
  config.engine = "one";
  JobRequest request;
  std::string first;
  {
    ServerRig rig(directory.path(), 2, {}, config);
    request = small_job(rig.add_scene("a room")->scene.record.id);
    request.reuse = true;
    first = rig.submit(request)->job.id;
    rig.wait_final(first);
  }
  {
    ServerRig rig(directory.path(), 2, {}, config);
    EXPECT_EQ(rig.submit(request)->job.id, first);
  }
  config.engine = "two";
  ServerRig rig(directory.path(), 2, {}, config);
  const auto again = rig.submit(request);
  EXPECT_FALSE(again->reused);
  EXPECT_NE(again->job.id, first);
}

TEST(Restart, ShutdownLetsWorkDrain) {
  const TempDirectory directory;
  std::string id;
  {
    ServerRig rig(directory.path());
    id = rig.submit(small_job(rig.add_scene("a room")->scene.record.id, 64))->job.id;
    rig.follow(id, [](const auto& s) { return s.state != JobState::kQueued; });
    rig.scheduler->shutdown(60s);
  }
  ServerRig rig(directory.path());
  EXPECT_EQ(rig.get(id)->state, JobState::kCompleted);
}

}  // namespace
}  // namespace raykiln::tests
