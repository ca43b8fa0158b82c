#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "raykiln/shading/emitters.hpp"

namespace raykiln::render {
namespace {

/// Triangles of the given edge length in the plane z = index, one material each.
Scene triangles_of(const std::vector<std::pair<float, Rgb>>& list) {
  Scene scene;
  for (std::uint32_t i = 0; i < list.size(); ++i) {
    const auto z = static_cast<float>(i);
    const float edge = list[i].first;
    scene.mesh.positions.insert(scene.mesh.positions.end(), {{0, 0, z}, {edge, 0, z}, {0, edge, z}});
    scene.mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    scene.mesh.material_ids.push_back(i);
    Material material;
    material.emission = list[i].second;
    scene.materials.push_back(material);
  }
  return scene;
}

TEST(Emitters, DrawnByAreaAndLargestChannel) {
  const Scene scene = triangles_of({{1.0F, {0, 3, 1}}, {2.0F, Rgb(0.0F)}, {0.0F, Rgb(5.0F)}, {3.0F, {1, 0, 0}}});
  const Emitters emitters(scene);
  ASSERT_TRUE(emitters.has_triangles());
  double first = 0.0;
  constexpr int kCount = 40000;
  for (std::uint64_t i = 0; i < kCount; ++i) {
    const EmitterSample s = emitters.sample(scene, vertex_key(path_key(1, i, 0), 0, 0));
    ASSERT_TRUE(s.point.material == 0 || s.point.material == 3);
    first += s.point.material == 0;
    EXPECT_DOUBLE_EQ(s.pdf_area, s.point.material == 0 ? 3.0 / 6.0 : 1.0 / 6.0);
  }
  // Powers 0.5 * 3 and 4.5 * 1: a quarter. 4 sigma.
  EXPECT_NEAR(first / kCount, 0.25, 4.0 * std::sqrt(0.1875 / kCount));
}

/// Axes anywhere, and aimed at points of emitters to within the width.
TEST(Emitters, NoPointLiesAlongAnAxisThatMissesTheirBox) {
  const Scene scene = triangles_of({{1.0F, Rgb(1.0F)}, {0.5F, Rgb(2.0F)}});
  const Emitters emitters(scene);
  constexpr double kWidth = 2e-6;
  int missed = 0;
  for (std::uint64_t i = 0; i < 4000; ++i) {
    const VertexKey key = vertex_key(path_key(3, i, 0), 0, 0);
    const auto number = [&](Dimension d) { return 2.0 * uniform(key, d) - 1.0; };
    const double far = std::pow(10.0, static_cast<double>(i % 7) - 3.0);
    const Vec3d from = far * Vec3d(number(Dimension::kLensX), number(Dimension::kLensY), number(Dimension::kLobeChoice));
    const EmitterSample sample = emitters.sample(scene, key);
    const Vec3d to = normalize(sample.point.p - from);
    const Vec3d aside(number(Dimension::kPixelX), number(Dimension::kPixelY), number(Dimension::kFresnelChoice));
    const Vec3f aimed(normalize(to + 0.9 * kWidth * normalize(cross(to, aside))));
    EXPECT_TRUE(emitters.may_lie_along(from, aimed, kWidth)) << i;
    const Vec3f axis(normalize(aside));
    if (emitters.may_lie_along(from, axis, kWidth)) continue;
    ++missed;
    EXPECT_GT(length(to - Vec3d(axis)), kWidth) << i;
  }
  EXPECT_GT(missed, 1000);
}

TEST(Emitters, AxesAlongThePlanesOfTheirBox) {
  const Scene scene = triangles_of({{1.0F, Rgb(1.0F)}});
  const Emitters emitters(scene);
  EXPECT_TRUE(emitters.may_lie_along({-5.0, 0.5, 0.0}, {1, 0, 0}, 2e-6));
  EXPECT_TRUE(emitters.may_lie_along({-5.0, 0.0, 0.0}, {1, 0, 0}, 2e-6));
  EXPECT_FALSE(emitters.may_lie_along({-5.0, 0.5, 0.0}, {-1, 0, 0}, 2e-6));
  EXPECT_FALSE(emitters.may_lie_along({-5.0, 0.5, 0.1}, {1, 0, 0}, 2e-6));
  EXPECT_TRUE(emitters.may_lie_along({0.25, 0.25, 7.0}, {0, 0, -1}, 2e-6));
}

TEST(Emitters, NothingShines) {
  Scene scene = triangles_of({{1.0F, Rgb(0.0F)}});
  scene.point_lights.push_back({});
  const Emitters emitters(scene);
  EXPECT_FALSE(emitters.has_triangles());
  EXPECT_TRUE(emitters.point_lights().empty());
}

TEST(PowerHeuristic, SumsToOneAndSurvivesHugeDensities) {
  for (const auto& [p, q] : {std::pair{1.0, 3.0}, {1e12, 1e-3}, {1e300, 1e300}, {1e-200, 1e200}}) {
    EXPECT_NEAR(power_heuristic(p, q) + power_heuristic(q, p), 1.0, 1e-12);
  }
  EXPECT_EQ(power_heuristic(2.0, 0.0), 1.0);
  EXPECT_EQ(power_heuristic(2.0, std::numeric_limits<double>::infinity()), 0.0);
}

}  // namespace
}  // namespace raykiln::render
