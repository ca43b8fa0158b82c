#include "raykiln/shading/coverage.hpp"

#include <algorithm>

#include "raykiln/scene/surface_textures.hpp"

namespace raykiln::render {
namespace {

/// Null where the material has no texture of it.
const MaterialTextures* alpha_of(const Scene& scene, std::uint32_t material) {
  if (scene.textures == nullptr || material >= scene.textures->materials.size()) return nullptr;
  const MaterialTextures& used = scene.textures->materials[material];
  return used.alpha.used() ? &used : nullptr;
}

double covered(const MaterialTextures& used, double alpha) {
  if (used.alpha_cutoff) return alpha >= *used.alpha_cutoff ? 1.0 : 0.0;
  return std::clamp(alpha, 0.0, 1.0);
}

}  // namespace

bool has_open_parts(const Scene& scene, std::uint32_t material) {
  return scene.materials[material].coverage < 1.0F || alpha_of(scene, material) != nullptr;
}

double coverage_at(const Scene& scene, const TrianglePlace& at) {
  const std::uint32_t material = scene.mesh.material_ids[at.id];
  const auto factor = static_cast<double>(scene.materials[material].coverage);
  const MaterialTextures* used = alpha_of(scene, material);
  if (used == nullptr) return factor;
  return covered(*used, factor * texture_value(*scene.textures, used->alpha, at).x);
}

double mean_coverage(const Scene& scene, std::uint32_t material) {
  const auto factor = static_cast<double>(scene.materials[material].coverage);
  const MaterialTextures* used = alpha_of(scene, material);
  if (used == nullptr) return factor;
  const TextureImage& image = scene.textures->images[used->alpha.image];
  const double texels = static_cast<double>(image.width) * image.height;
  double sum = 0.0;
  for (const std::uint8_t value : image.srgb8) sum += covered(*used, factor * value / 255.0);
  for (const float value : image.linear) sum += covered(*used, factor * static_cast<double>(value));
  return sum / texels;
}

double Gaps::met(const TrianglePlace& at, const Vec3d& direction) const {
  if (back_faces && scene->materials[scene->mesh.material_ids[at.id]].one_sided) {
    const auto& corner = scene->mesh.triangles[at.id];
    const Vec3d p(scene->mesh.positions[corner[0]]);
    const Vec3d normal = cross(Vec3d(scene->mesh.positions[corner[1]]) - p,
                               Vec3d(scene->mesh.positions[corner[2]]) - p);
    if (dot(normal, direction) > 0.0) return 0.0;
  }
  return open_parts ? coverage_at(*scene, at) : 1.0;
}

Gaps gaps_of(const Scene& scene) {
  Gaps gaps{.scene = &scene};
  for (std::uint32_t id = 0; id < scene.materials.size(); ++id) {
    gaps.open_parts = gaps.open_parts || has_open_parts(scene, id);
    gaps.back_faces = gaps.back_faces || scene.materials[id].one_sided;
  }
  return gaps;
}

}  // namespace raykiln::render
