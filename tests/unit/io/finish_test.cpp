// Re-centring, rounding, dropping and defaults.
#include <cmath>
#include <cstring>
#include <string>

#include "recentre.hpp"
#include "support/io/import_text.hpp"

namespace raykiln::render::test {
namespace {

using Warn = ImportWarningCode;

std::string number(double x) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", x);
  return text;
}

// A relief of 1 mm steps on a 1 m square, moved and scaled.
std::string relief(const Vec3d& shift, double scale) {
  std::string text;
  for (int y = 0; y <= 10; ++y) {
    for (int x = 0; x <= 10; ++x) {
      const Vec3d p = (Vec3d(x * 0.125, (x * 7 + y * 5) % 4 * 0.0009765625, y * 0.125) + shift) * scale;
      text += "v " + number(p.x) + " " + number(p.y) + " " + number(p.z) + "\n";
    }
  }
  for (int y = 0; y < 10; ++y) {
    for (int x = 0; x < 10; ++x) {
      const int i = y * 11 + x + 1;
      text += "f " + std::to_string(i) + " " + std::to_string(i + 1) + " " +
              std::to_string(i + 12) + "\n";
    }
  }
  return text;
}

TEST(Recentre, AThousandKilometresAwayKeepsEveryBit) {
  const auto near = expect_scene({{"a.obj", relief(Vec3d(0.0), 1.0)}});
  const auto far = expect_scene({{"a.obj", relief(Vec3d(1e6, -3e6, 5e8), 1.0)}});
  ASSERT_EQ(near.scene.mesh.positions.size(), far.scene.mesh.positions.size());
  EXPECT_EQ(near.scene.origin, Vec3d(0.0));
  const Vec3d shift = Vec3d(1e6, -3e6, 5e8) - far.scene.origin;
  for (std::size_t i = 0; i < near.scene.mesh.positions.size(); ++i) {
    const Vec3d expected = Vec3d(near.scene.mesh.positions[i]) + shift;
    ASSERT_EQ(Vec3d(far.scene.mesh.positions[i]), expected) << i;
  }
}

TEST(Recentre, ScalingByPowersOfTwoScalesEveryBit) {
  const auto one = expect_scene({{"a.obj", relief(Vec3d(100.0, 7.0, -300.0), 1.0)}});
  for (const int k : {-40, -10, 10, 30}) {
    const double scale = std::ldexp(1.0, k);
    const auto other = expect_scene({{"a.obj", relief(Vec3d(100.0, 7.0, -300.0), scale)}});
    ASSERT_EQ(other.scene.origin, one.scene.origin * scale);
    for (std::size_t i = 0; i < one.scene.mesh.positions.size(); ++i) {
      const Vec3f expected = one.scene.mesh.positions[i] * static_cast<float>(scale);
      ASSERT_EQ(other.scene.mesh.positions[i], expected) << "2^" << k;
    }
  }
}

TEST(Recentre, NearScenesKeepTheirCoordinates) {
  EXPECT_EQ(io::choose_origin({Vec3d(0.0), Vec3d(1.0)}), Vec3d(0.0));
  EXPECT_EQ(io::choose_origin({Vec3d(1.0, 0.0, 0.0), Vec3d(2.0, 1.0, 1.0)}), Vec3d(0.0));
  EXPECT_NE(io::choose_origin({Vec3d(2.0, 0.0, 0.0), Vec3d(3.0, 1.0, 1.0)}), Vec3d(0.0));
}

TEST(Recentre, CamerasAndLightsMoveAlong) {
  const auto imported = expect_scene(
      {{"a.obj", relief(Vec3d(1e6, 0.0, 0.0), 1.0)},
       {"raykiln.json", R"({"camera": {"eye": [1000000.5, 0, 3], "look_at": [1000000.5, 0, 0]},
         "point_lights": [{"position": [1000000.25, 2, 0], "intensity": [1, 1, 1]}]})"}});
  const Scene& scene = imported.scene;
  ASSERT_NE(scene.origin.x, 0.0);
  EXPECT_EQ(scene.cameras[0].eye + scene.origin, Vec3d(1000000.5, 0.0, 3.0));
  EXPECT_EQ(Vec3d(scene.point_lights[0].position) + scene.origin, Vec3d(1000000.25, 2.0, 0.0));
}

TEST(FlatTriangles, AreDroppedAndCounted) {
  const std::string text =
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nf 1 1 1\nf 1 2 2\nf 1 2 4\nf 1 2 3\n";
  const auto imported = expect_scene({{"a.obj", text}});
  EXPECT_EQ(imported.scene.mesh.triangles.size(), 1U);
  EXPECT_EQ(imported.report.source_triangles, 4U);
  EXPECT_EQ(imported.report.zero_area_triangles, 3U);
  EXPECT_EQ(count_of(imported, Warn::kZeroAreaTriangles), 3U);
  EXPECT_EQ(imported.scene.bounds.hi.x, 1.0F) << "the bounds hold what is kept";
}

TEST(FlatTriangles, CollapsedOnesAreToldApart) {
  const std::string text =
      "v 0 0 0\nv 1000 0 0\nv 0 1000 0\nf 1 2 3\n"
      "v 900 0 0\nv 900.000001 0 0\nv 900 0.000001 0\nf 4 5 6\n";
  const auto imported = expect_scene({{"a.obj", text}});
  EXPECT_EQ(count_of(imported, Warn::kCollapsedTriangles), 1U);
  EXPECT_EQ(count_of(imported, Warn::kZeroAreaTriangles), 0U);
}

const std::string kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

TEST(Defaults, ASceneWithoutLightGetsAGreyBackgroundAndALamp) {
  const auto imported = expect_scene({{"a.obj", kTriangle}});
  EXPECT_EQ(imported.scene.background, Rgb(0.3F));
  ASSERT_EQ(imported.scene.point_lights.size(), 1U);
  const auto& lamp = imported.scene.point_lights[0];
  const Vec3d way = Vec3d(lamp.position) - Vec3d(0.5, 0.5, 0.0);
  EXPECT_NEAR(static_cast<double>(lamp.intensity.x) / dot(way, way), 3.0, 1e-5);
  EXPECT_EQ(count_of(imported, Warn::kDefaultBackground), 1U);
  EXPECT_EQ(count_of(imported, Warn::kNoLight), 0U);
}

TEST(Defaults, AnExplicitBlackBackgroundStays) {
  const auto imported =
      expect_scene({{"a.obj", kTriangle}, {"raykiln.json", R"({"background": [0, 0, 0]})"}});
  EXPECT_EQ(imported.scene.background, Rgb(0.0F));
  EXPECT_TRUE(imported.scene.point_lights.empty());
  EXPECT_EQ(count_of(imported, Warn::kNoLight), 1U);
}

TEST(Defaults, EmissionIsLight) {
  const auto imported = expect_scene(
      {{"a.obj", kTriangle}, {"raykiln.json", R"({"materials": {"default": {"emission": [1, 0, 0]}}})"}});
  EXPECT_EQ(imported.scene.background, Rgb(0.0F));
  EXPECT_EQ(count_of(imported, Warn::kDefaultBackground), 0U);
}

TEST(Defaults, TheCameraSeesAllOfTheScene) {
  const auto imported = expect_scene({{"a.obj", relief(Vec3d(40.0, 5.0, -90.0), 1.0)}});
  ASSERT_EQ(imported.scene.cameras.size(), 1U);
  EXPECT_EQ(count_of(imported, Warn::kDefaultCamera), 1U);
  const Camera& camera = imported.scene.cameras[0];
  const double slope = std::tan(0.5 * camera.fov_y_rad);
  for (const Vec3f& p : imported.scene.mesh.positions) {
    const Vec3d v = Vec3d(p) - camera.eye;
    const double depth = dot(v, camera.forward);
    ASSERT_GT(depth, 0.0);
    ASSERT_LE(std::abs(dot(v, camera.up)), slope * depth);
    ASSERT_LE(std::abs(dot(v, camera.right)), slope * depth);
  }
}

}  // namespace
}  // namespace raykiln::render::test
