// Importing from literals, for tests.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "raykiln/io/import.hpp"
#include "raykiln/scene/surface_textures.hpp"

namespace raykiln::render::test {

using Texts = std::map<std::string, std::string>;

inline ImportResult import_texts(Texts files, const ImportOptions& options = {}) {
  return import_scene(MemoryFiles(std::move(files)), options);
}

/// The imported scene; a failed expectation and an empty one when there was an error.
inline ImportedScene expect_scene(Texts files, const ImportOptions& options = {}) {
  ImportResult result = import_texts(std::move(files), options);
  if (auto* scene = std::get_if<ImportedScene>(&result)) return std::move(*scene);
  const auto& error = std::get<ImportError>(result);
  ADD_FAILURE() << name(error.code) << ": " << error.message << " [" << error.file << " "
                << error.where << "]";
  return {};
}

inline ImportError expect_error(Texts files, const ImportOptions& options = {}) {
  ImportResult result = import_texts(std::move(files), options);
  if (auto* error = std::get_if<ImportError>(&result)) return std::move(*error);
  ADD_FAILURE() << "the import succeeded";
  return {};
}

/// Occurrences of a warning, 0 when it was not given.
inline std::uint64_t count_of(const ImportedScene& imported, ImportWarningCode code) {
  std::uint64_t count = 0;
  for (const ImportWarning& warning : imported.report.warnings) {
    if (warning.code == code) count += warning.count;
  }
  return count;
}

/// Area of triangle `i` in the scene's units.
inline double area(const Scene& scene, std::size_t i) {
  const auto& t = scene.mesh.triangles[i];
  const Vec3d a(scene.mesh.positions[t[0]]);
  const Vec3d b(scene.mesh.positions[t[1]]);
  const Vec3d c(scene.mesh.positions[t[2]]);
  return 0.5 * length(cross(b - a, c - a));
}

inline double total_area(const Scene& scene) {
  double sum = 0.0;
  for (std::size_t i = 0; i < scene.mesh.triangles.size(); ++i) sum += area(scene, i);
  return sum;
}

inline Vec3d normal_of(const Scene& scene, std::size_t i) {
  const auto& t = scene.mesh.triangles[i];
  const Vec3d a(scene.mesh.positions[t[0]]);
  return normalize(cross(Vec3d(scene.mesh.positions[t[1]]) - a,
                         Vec3d(scene.mesh.positions[t[2]]) - a));
}

inline void expect_sound(const SurfaceTextures& textures, const Scene& scene) {
  ASSERT_EQ(textures.materials.size(), scene.materials.size());
  for (const TextureImage& image : textures.images) {
    ASSERT_TRUE(image.width > 0 && image.height > 0);
    ASSERT_TRUE(image.channels == 1 || image.channels == 3);
    const std::size_t values = static_cast<std::size_t>(image.channels) * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
    ASSERT_EQ(image.srgb8.size() + image.linear.size(), values);
    ASSERT_TRUE(image.srgb8.empty() || image.linear.empty());
    for (const float value : image.linear) ASSERT_TRUE(value >= 0.0F && value <= 1.0F);
  }
  for (const MaterialTextures& used : textures.materials) {
    for (const TextureUse* use : used.uses()) {
      if (!use->used()) continue;
      ASSERT_LT(use->image, textures.images.size());
      ASSERT_LT(use->uv_set, textures.uv_sets.size());
      for (int i = 0; i < 3; ++i) ASSERT_TRUE(std::isfinite(use->u_row[i]) && std::isfinite(use->v_row[i]));
    }
  }
  for (const UvSet& set : textures.uv_sets) {
    ASSERT_LE(set.corners.size(), scene.mesh.triangles.size());
    for (const auto& corners : set.corners) {
      for (const std::uint32_t id : corners) ASSERT_TRUE(id == kNoUv || id < set.coordinates.size());
    }
  }
}

/// What import_scene promises of every scene that it returns.
inline void expect_sound(const ImportedScene& imported) {
  const Scene& scene = imported.scene;
  const TriangleMesh& mesh = scene.mesh;
  const auto finite = [](const Vec3f& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
  };
  ASSERT_FALSE(mesh.triangles.empty());
  ASSERT_FALSE(scene.materials.empty());
  ASSERT_FALSE(scene.cameras.empty());
  ASSERT_EQ(mesh.material_ids.size(), mesh.triangles.size());
  ASSERT_TRUE(mesh.corner_normals.empty() || mesh.corner_normals.size() == mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    ASSERT_LT(mesh.material_ids[i], scene.materials.size());
    for (std::size_t k = 0; k < 3; ++k) {
      ASSERT_LT(mesh.triangles[i][k], mesh.positions.size());
      if (mesh.corner_normals.empty() || mesh.corner_normals[i][k] == kNoNormal) continue;
      ASSERT_LT(mesh.corner_normals[i][k], mesh.normals.size());
      const double size = length(Vec3d(mesh.normals[mesh.corner_normals[i][k]]));
      ASSERT_NEAR(size, 1.0, 1e-6);
    }
  }
  for (const Vec3f& p : mesh.positions) ASSERT_TRUE(finite(p));
  ASSERT_TRUE(finite(scene.bounds.lo) && finite(scene.bounds.hi) && !scene.bounds.empty());
  for (const Material& m : scene.materials) {
    ASSERT_TRUE(finite(m.diffuse) && finite(m.specular) && finite(m.emission));
    ASSERT_TRUE(m.transparent >= 0.0F && m.transparent <= 1.0F);
    ASSERT_TRUE(m.specular_exp >= 0.0 && m.specular_exp <= 1e15);
    ASSERT_TRUE(m.facets.roughness >= 0.0 && m.facets.roughness <= 1.0);
    ASSERT_TRUE(m.facets.edge >= 0.0F && m.facets.edge <= 1.0F);
    ASSERT_TRUE(m.coverage >= 0.0F && m.coverage <= 1.0F);
    ASSERT_TRUE(finite(m.facets.diffuse_through) && finite(m.facets.tint) && finite(m.facets.absorption));
    ASSERT_TRUE(m.index_of_refraction > 0.0F && std::isfinite(m.index_of_refraction));
  }
  if (scene.textures != nullptr) expect_sound(*scene.textures, scene);
  for (const PointLight& l : scene.point_lights) ASSERT_TRUE(finite(l.position) && finite(l.intensity));
  for (const Camera& c : scene.cameras) {
    ASSERT_TRUE(finite(c.eye));
    ASSERT_NEAR(length(c.right), 1.0, 1e-6);
    ASSERT_NEAR(length(c.up), 1.0, 1e-6);
    ASSERT_NEAR(length(c.forward), 1.0, 1e-6);
    ASSERT_TRUE(c.fov_y_rad > 0.0 && c.fov_y_rad < 3.1416);
  }
}

}  // namespace raykiln::render::test
