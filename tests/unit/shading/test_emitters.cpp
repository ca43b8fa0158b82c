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
