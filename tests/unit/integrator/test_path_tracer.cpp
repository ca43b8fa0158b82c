#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "raykiln/integrator/path_tracer.hpp"
#include "support/effect_scenes.hpp"
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

/// Luminance of samples with at most 5 reflections.
struct Spread {
  double mean = 0.0, variance = 0.0;  ///< of one sample
  double relative = 0.0;              ///< mean over pixels of variance over squared mean
};
Spread spread_of(const Scene& scene, const KdTree& tree, std::span<const CausticCaster> casters, std::uint64_t first) {
  const Emitters emitters(scene);
  PathSettings settings;
  settings.max_depth = 5;
  PathTracer tracer({scene, tree, emitters, nullptr, casters}, CameraRays(scene.cameras[0], 16, 16, bounds(tree)), settings);
  std::vector<PathStart> starts;
  constexpr int kSamples = 512;
  for (int i = 0; i < 256 * kSamples; ++i) starts.push_back({i % 16, i / 16 % 16, first + static_cast<std::uint64_t>(i / 256)});
  std::vector<PathResult> results(starts.size());
  RenderStats stats;
  EXPECT_TRUE(tracer.trace(starts, results, stats, {}));
  std::vector<double> sum(256), square(256);
  for (std::size_t i = 0; i < results.size(); ++i) {
    const double y = luminance(results[i].radiance());
    sum[i % 256] += y;
    square[i % 256] += y * y;
  }
  Spread spread;
  for (std::size_t p = 0; p < 256; ++p) {
    const double mean = sum[p] / kSamples;
    spread.mean += mean / 256;
    const double variance = square[p] / kSamples - mean * mean;
    spread.variance += variance / 256;
    spread.relative += variance / (mean * mean) / 256;
  }
  return spread;
}

// 4 sigma of the difference of the two means: false alarm 6.3e-5.
TEST(CausticCastersInRooms, AreFoundMoreOftenWithTheSameMean) {
  support::SceneBuilder b;
  b.box(Vec3f(-1.0F), Vec3f(1.0F), b.material(support::diffuse_material(Rgb(0.6F))), true);
  b.quad({Vec3f(-0.25F, 0.999F, -0.25F), {0.25F, 0.999F, -0.25F}, {0.25F, 0.999F, 0.25F}, {-0.25F, 0.999F, 0.25F}},
         b.material(support::diffuse_material(Rgb(0.0F), Rgb(10.0F))));
  support::add_ball(b, {-0.5F, -0.8F, -0.5F}, 0.2F, 8, b.material(support::glass_material(1.5F, kLargestExponent)), false);
  support::add_ball(b, {0.1F, -0.5F, 0.0F}, 0.4F, 12, b.material(support::mirror_material(0.9F, kLargestExponent)), false);
  b.camera({0, 0, 0.99F}, {0, 0.2F, -1}, {0, 1, 0}, 1.8F);
  const Scene scene = b.scene();
  SerialTaskRunner runner;
  const auto tree = build_scene_tree(scene, {}, runner);
  const std::vector<CausticCaster> casters = find_caustic_casters(scene);
  ASSERT_EQ(casters.size(), 2U);
  const Spread with = spread_of(scene, *tree, casters, 0), without = spread_of(scene, *tree, {}, 512);
  EXPECT_NEAR(with.mean, without.mean, 4.0 * std::sqrt((with.variance + without.variance) / (256.0 * 512.0)));
  EXPECT_LT(with.relative, 0.85 * without.relative);
}

TEST(RaysOfOnePath, IsTheGeometricSum) {
  EXPECT_EQ(rays_of_one_path(1, 8), 9.0);
  EXPECT_EQ(rays_of_one_path(4, 5), 1365.0);
  EXPECT_EQ(rays_of_one_path(64, 0), 1.0);
  EXPECT_TRUE(std::isinf(rays_of_one_path(64, 4096)));
}

}  // namespace
}  // namespace raykiln::render
