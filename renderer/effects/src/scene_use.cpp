#include "raykiln/effects/scene_use.hpp"

#include <algorithm>
#include <cmath>

#include "raykiln/scene/environment_map.hpp"
#include "sources.hpp"

namespace raykiln::render {
namespace {

Vec3f plane_normal(const TriangleMesh& mesh, std::uint32_t id) {
  const auto& corner = mesh.triangles[id];
  const Vec3d p0(mesh.positions[corner[0]]);
  const Vec3d normal =
      cross(Vec3d(mesh.positions[corner[1]]) - p0, Vec3d(mesh.positions[corner[2]]) - p0);
  return Vec3f(normal / length(normal));
}

/// Interpolation gives the plane's normal, bit for bit, only where all three are that normal and it
/// is an axis: then the sum has one component s, and s / sqrt(s^2) is exactly 1 (sqrt is rounded
/// correctly).
bool is_flat(const TriangleMesh& mesh, std::uint32_t id) {
  const auto& corner = mesh.corner_normals[id];
  if (corner[0] == kNoNormal || corner[1] == kNoNormal || corner[2] == kNoNormal) return true;
  const Vec3f ng = plane_normal(mesh, id);
  const bool axis = std::abs(ng.x) == 1.0F || std::abs(ng.y) == 1.0F || std::abs(ng.z) == 1.0F;
  if (!axis) return false;
  for (const std::uint32_t c : corner) {
    if (mesh.normals[c] != ng) return false;
  }
  return true;
}

template <class Light>
std::uint64_t shining(const std::vector<Light>& lights, Rgb Light::*power) {
  return static_cast<std::uint64_t>(
      std::count_if(lights.begin(), lights.end(),
                    [power](const Light& light) { return !is_black(light.*power); }));
}

bool shines(const EnvironmentMap& map) {
  return std::any_of(map.rgb.begin(), map.rgb.end(), [](float value) { return value > 0.0F; });
}

}  // namespace

SceneUse use_of(const Scene& scene) {
  const TriangleMesh& mesh = scene.mesh;
  SceneUse use;
  use.shining_point_lights = shining(scene.point_lights, &PointLight::intensity);
  use.shining_spot_lights = shining(scene.spot_lights, &SpotLight::intensity);
  use.shining_directional_lights =
      shining(scene.directional_lights, &DirectionalLight::irradiance);
  use.environment_shines = scene.environment != nullptr && shines(*scene.environment);
  std::vector<bool> used(scene.materials.size(), false);
  for (std::uint32_t id = 0; id < mesh.triangles.size(); ++id) {
    const std::uint32_t material = mesh.material_ids[id];
    used[material] = true;
    if (mesh.corner_normals.empty() || use.smooth_triangle) continue;
    if (is_reflecting(scene.materials[material]) && !is_flat(mesh, id)) use.smooth_triangle = id;
  }
  for (std::uint32_t m = 0; m < used.size(); ++m) {
    if (used[m]) use.materials.push_back(m);
  }
  return use;
}

void drop_unused(Scene& scene) {
  TriangleMesh& mesh = scene.mesh;
  if (mesh.normals.empty() || use_of(scene).smooth_triangle) return;
  // Neither clear() nor = {}, which keep the memory.
  decltype(mesh.normals)().swap(mesh.normals);
  decltype(mesh.corner_normals)().swap(mesh.corner_normals);
}

}  // namespace raykiln::render
