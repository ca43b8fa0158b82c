#include <gtest/gtest.h>

#include <algorithm>

#include "raykiln/integrator/path_tracer.hpp"
#include "support/scene_pieces.hpp"

namespace raykiln::render {
namespace {

class PathTracerTest : public testing::Test {
 protected:
  PathTracerTest() {
    SerialTaskRunner runner;
    tree_ = build_scene_tree(scene_, {}, runner);
    for (int i = 0; i < 600; ++i) starts_.push_back({i % 30, i / 30, static_cast<std::uint64_t>(i)});
  }

  std::vector<PathResult> trace(std::span<const PathStart> starts, const PathSettings& settings) {
    PathTracer tracer({scene_, *tree_, emitters_}, CameraRays(scene_.cameras[0], 30, 20, bounds(*tree_)), settings);
    std::vector<PathResult> results(starts.size());
    RenderStats stats;
    EXPECT_TRUE(tracer.trace(starts, results, stats, {}));
    return results;
  }

  Scene scene_ = support::mixed_room().scene();
  Emitters emitters_{scene_};
  std::shared_ptr<const KdTree> tree_;
  std::vector<PathStart> starts_;
};

bool equal(const PathResult& a, const PathResult& b) {
  return a.emitted == b.emitted && a.direct == b.direct && a.truncated == b.truncated;
}

TEST_F(PathTracerTest, AResultDependsOnItsStartAlone) {
  for (const int branches : {1, 4}) {
    PathSettings settings;
    settings.max_depth = 4;
    settings.branches = branches;
    const auto together = trace(starts_, settings);
    std::vector<PathStart> backwards(starts_.rbegin(), starts_.rend());
    const auto turned = trace(backwards, settings);
    for (std::size_t i = 0; i < starts_.size(); ++i) {
      EXPECT_TRUE(equal(together[i], turned[starts_.size() - 1 - i])) << i;
      if (i % 50 != 0) continue;
      EXPECT_TRUE(equal(together[i], trace({&starts_[i], 1}, settings)[0])) << i;
    }
  }
}

TEST_F(PathTracerTest, ScratchLeavesNothingBehind) {
  PathTracer tracer({scene_, *tree_, emitters_}, CameraRays(scene_.cameras[0], 30, 20, bounds(*tree_)), {});
  std::vector<PathResult> first(starts_.size()), second(starts_.size());
  RenderStats stats;
  std::stop_source stopped;
  stopped.request_stop();
  ASSERT_TRUE(tracer.trace(starts_, first, stats, {}));
  ASSERT_FALSE(tracer.trace(starts_, second, stats, stopped.get_token()));
  ASSERT_TRUE(tracer.trace(starts_, second, stats, {}));
  EXPECT_TRUE(std::equal(first.begin(), first.end(), second.begin(), equal));
}

TEST_F(PathTracerTest, PathsThatRouletteEndsAreCounted) {
  const auto ended = [this](bool roulette) {
    PathSettings settings;
    settings.max_depth = 128;
    settings.bsdf.light.roulette = roulette;
    PathTracer tracer({scene_, *tree_, emitters_}, CameraRays(scene_.cameras[0], 30, 20, bounds(*tree_)), settings);
    std::vector<PathResult> results(starts_.size());
    RenderStats stats;
    EXPECT_TRUE(tracer.trace(starts_, results, stats, {}));
    EXPECT_LE(stats.roulette_ends, stats.camera_rays) << "one path ends once";
    return stats.roulette_ends;
  };
  EXPECT_GT(ended(true), 0U);
  EXPECT_EQ(ended(false), 0U);
}

TEST_F(PathTracerTest, DepthZeroSeesLampsAndPointLightsOnly) {
  PathSettings settings;
  settings.max_depth = 0;
  PathTracer tracer({scene_, *tree_, emitters_}, CameraRays(scene_.cameras[0], 30, 20, bounds(*tree_)), settings);
  std::vector<PathResult> results(starts_.size());
  RenderStats stats;
  ASSERT_TRUE(tracer.trace(starts_, results, stats, {}));
  EXPECT_EQ(stats.bounce_rays, 0U);
  EXPECT_LE(stats.shadow_rays, stats.camera_rays);
  EXPECT_GT(stats.shadow_rays, 0U);
}

TEST(RaysOfOnePath, IsTheGeometricSum) {
  EXPECT_EQ(rays_of_one_path(1, 8), 9.0);
  EXPECT_EQ(rays_of_one_path(4, 5), 1365.0);
  EXPECT_EQ(rays_of_one_path(64, 0), 1.0);
  EXPECT_TRUE(std::isinf(rays_of_one_path(64, 4096)));
}

}  // namespace
}  // namespace raykiln::render
