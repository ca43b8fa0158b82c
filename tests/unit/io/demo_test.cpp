// The bundled demo scene.
#include <cmath>

#include "support/io/import_text.hpp"

namespace raykiln::render::test {
namespace {

TEST(Demo, ImportsWithoutAWarning) {
  const ImportResult result = import_scene(DirectoryFiles(RAYKILN_DEMO));
  ASSERT_TRUE(std::holds_alternative<ImportedScene>(result))
      << std::get<ImportError>(result).message;
  const auto& imported = std::get<ImportedScene>(result);
  EXPECT_TRUE(imported.report.warnings.empty()) << imported.report.warnings[0].message;
  EXPECT_EQ(imported.scene.mesh.triangles.size(), 5144U);
  EXPECT_EQ(imported.scene.cameras.at(0).name, "front");
  expect_sound(imported);
}

// The volume inside a closed surface is positive exactly when its winding faces outwards.
TEST(Demo, TheGlassBallFacesOutwards) {
  const ImportResult result = import_scene(DirectoryFiles(RAYKILN_DEMO));
  const Scene& scene = std::get<ImportedScene>(result).scene;
  double volume = 0.0;
  for (std::size_t i = 0; i < scene.mesh.triangles.size(); ++i) {
    if (scene.materials[scene.mesh.material_ids[i]].name != "glass") continue;
    const auto& t = scene.mesh.triangles[i];
    const Vec3d a(scene.mesh.positions[t[0]]);
    volume += dot(a, cross(Vec3d(scene.mesh.positions[t[1]]), Vec3d(scene.mesh.positions[t[2]]))) / 6;
    const Vec3d shading(scene.mesh.normals[scene.mesh.corner_normals[i][0]]);
    EXPECT_GT(dot(shading, normal_of(scene, i)), 0.99);
  }
  EXPECT_NEAR(volume, 4.0 / 3.0 * 3.14159265 * 0.4 * 0.4 * 0.4, 0.002);
}

}  // namespace
}  // namespace raykiln::render::test
