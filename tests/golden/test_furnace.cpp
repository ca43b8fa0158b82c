// Closed rooms that emit and reflect: the series of reflections is known in closed form.
#include <gtest/gtest.h>

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

// L_D = E (1 - rho^(D + 1)) / (1 - rho). 4 sigma, 12 checks: false alarm 8e-4.
TEST(Furnace, TruncatedSeriesForEveryEstimator) {
  const std::vector<Row> rows{{0.2F, 0.8F, 0, 0.2},      {0.2F, 0.8F, 4, 0.672320},
                              {0.2F, 0.8F, 8, 0.865782}, {0.1F, 0.9F, 4, 0.409510},
                              {0.5F, 0.5F, 4, 0.968750}, {0.1F, 0.9F, 16, 0.833228}};
  for (const Row& row : rows) {
    const auto scene = furnace(row.emission, row.albedo).prepare();
    for (const bool emitters : {false, true}) {
      RenderSettings settings = square(16, row.depth);
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

}  // namespace
}  // namespace raykiln::render
