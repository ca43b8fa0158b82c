// The picture does not depend on who rendered what when.
#include <gtest/gtest.h>

#include "support/server_rig.hpp"
#include "support/temp_directory.hpp"

namespace raykiln::tests {
namespace {

using namespace server;

std::vector<float> picture(int threads, int tile, double task_seconds) {
  const TempDirectory directory;
  Config config;
  config.scheduler.task_seconds_target = task_seconds;
  config.scheduler.task_seconds_high = 2.0 * task_seconds;
  ServerRig rig(directory.path(), threads, {}, config);
  JobRequest request = small_job(rig.add_scene("a room")->scene.record.id, 21);
  request.tile = tile;
  const auto job = rig.submit(request);
  EXPECT_EQ(rig.wait_final(job->job.id).state, JobState::kCompleted);
  return (*rig.image(job->job.id))->image.rgb;
}

TEST(SameBytes, ForAnyPoolTileAndTaskLength) {
  const auto expected = picture(1, 64, 0.025);
  EXPECT_EQ(picture(2, 64, 0.025), expected);
  EXPECT_EQ(picture(7, 64, 0.025), expected);
  EXPECT_EQ(picture(2, 16, 0.001), expected);
  EXPECT_EQ(picture(2, 1000, 0.002), expected);
  EXPECT_EQ(picture(2, 3, 0.01), expected);
}

/// The picture of a job is the ordered sum of its tile results, made here without any server.
TEST(SameBytes, AsTheOrderedSumOfTileResults) {
  const auto scene = std::make_shared<const render::Scene>(tiny_scene());
  render::SerialTaskRunner serial;
  const auto prepared =
      render::prepare(scene, render::build_scene_tree(*scene, render::BuildParams{}, serial));
  render::RenderSettings settings;
  settings.width = 96;
  settings.height = 64;
  settings.max_depth = 3;
  render::Film film(96, 64);
  render::merge(film, render::render_tile(*prepared, settings, {0, 0, 96, 64},
                                          render::blocks_for(21), {}));
  EXPECT_EQ(film.resolve().rgb, picture(2, 32, 0.005));
}

}  // namespace
}  // namespace raykiln::tests
