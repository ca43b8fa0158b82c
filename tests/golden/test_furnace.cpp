// Closed rooms that emit and reflect: the series of reflections is known in closed form.
#include <gtest/gtest.h>

#include <cmath>

#include "support/scene_pieces.hpp"

namespace raykiln::render {
namespace {

using support::diffuse_material;
using support::Estimate;
using support::SceneBuilder;

SceneBuilder furnace(float emission, float albedo) {
  SceneBuilder b;
  b.box(Vec3f(-1.0F), Vec3f(1.0F), b.material(diffuse_material(Rgb(albedo), Rgb(emission))), true);
  b.camera({0.1F, 0.2F, 0.3F}, {1.0F, 0.5F, 0.0F}, {0, 1, 0}, 1.5F);
  return b;
}

RenderSettings square(int side, int depth) {
  RenderSettings settings;
  settings.width = settings.height = side;
  settings.max_depth = depth;
  return settings;
}

struct Row {
  float emission, albedo;
  int depth;
  double truth;
};

/// The physical model without roulette, so that every path reaches its depth; and the seed's.
std::vector<LightModel> fixed_depth_models() {
  LightModel physical;
  physical.roulette = false;
  return {physical, kSeedModel};
}

// L_D = E (1 - rho^(D + 1)) / (1 - rho). 4 sigma, 24 checks: false alarm 1.5e-3.
TEST(Furnace, TruncatedSeriesForEveryEstimator) {
  const std::vector<Row> rows{{0.2F, 0.8F, 0, 0.2},      {0.2F, 0.8F, 4, 0.672320},
                              {0.2F, 0.8F, 8, 0.865782}, {0.1F, 0.9F, 4, 0.409510},
                              {0.5F, 0.5F, 4, 0.968750}, {0.1F, 0.9F, 16, 0.833228}};
  for (const Row& row : rows) {
    const auto scene = furnace(row.emission, row.albedo).prepare();
    for (const LightModel& model : fixed_depth_models()) {
      for (const bool emitters : {false, true}) {
        RenderSettings settings = square(16, row.depth);
        settings.light_model = model;
        settings.emitter_sampling = emitters;
        const TileResult result = support::render_all(*scene, settings, 64);
        const Estimate e = support::estimate(result);
        EXPECT_NEAR(e.mean.y, row.truth, 4.0 * e.standard_error + 2e-6 * row.truth)
            << "albedo " << row.albedo << " depth " << row.depth << " emitters " << emitters;
        EXPECT_EQ(result.stats.non_finite, 0U);
        EXPECT_EQ(result.stats.truncated, result.stats.paths);  // nothing leaves a closed room
      }
    }
  }
}

/// Rays that follow a camera ray where roulette begins at the second reflection and lets paths go on with three
/// times their throughput rho^k: m - 1 for certain, m the first k >= 2 with 3 rho^k < 1, and 3 rho^m (1 + rho + ...)
/// beyond.
double expected_bounces(double rho) {
  int m = 2;
  while (3.0 * std::pow(rho, m) >= 1.0) ++m;
  return m - 1 + 3.0 * std::pow(rho, m) / (1.0 - rho);
}

// Roulette has no bias: E / (1 - rho) without the factor 1 - rho^(D + 1). 6 checks: 4e-4.
TEST(Furnace, RouletteReachesTheWholeSeries) {
  for (const float albedo : {0.5F, 0.8F, 0.9F}) {
    const auto scene = furnace(1.0F - albedo, albedo).prepare();
    for (const bool emitters : {false, true}) {
      RenderSettings settings = square(16, 8);
      settings.max_depth.reset();
      settings.emitter_sampling = emitters;
      const TileResult result = support::render_all(*scene, settings, 64);
      const Estimate e = support::estimate(result);
      EXPECT_NEAR(e.mean.y, 1.0, 4.0 * e.standard_error + 2e-6) << albedo << ' ' << emitters;
      EXPECT_LT(e.standard_error, 0.02);
      EXPECT_LT(result.stats.truncated, result.stats.paths / 1000);
      const double expected = expected_bounces(static_cast<double>(albedo));
      EXPECT_NEAR(static_cast<double>(result.stats.bounce_rays) / static_cast<double>(result.stats.paths), expected,
                  0.03 * expected);
    }
  }
}

}  // namespace
}  // namespace raykiln::render
