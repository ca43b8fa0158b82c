// Named scenes that call for few, some and all effects: what leaving effects out is measured on.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "raykiln/effects/effect_plan.hpp"
#include "support/scene_pieces.hpp"

namespace raykiln::render::support {

/// A scene with the settings that it is looked at with.
struct EffectScene {
  std::string name;
  SceneBuilder builder;
  RenderSettings settings;
};

/// Triangles on a sphere, 2 n^2 less the caps; with the exact normals where `smooth`.
inline void add_ball(SceneBuilder& b, const Vec3f& centre, float radius, int n,
                     std::uint32_t material, bool smooth) {
  const auto direction = [&](int i, int j) {
    const double theta = 3.14159265358979 * i / n, phi = 6.28318530717959 * j / n;
    return Vec3d(std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi));
  };
  TriangleMesh& mesh = b.scene().mesh;
  const auto add = [&](const std::array<Vec3d, 3>& d) {
    const auto at = [&](std::size_t k) {
      return Vec3f(Vec3d(centre) + static_cast<double>(radius) * d[k]);
    };
    b.triangle(at(0), at(1), at(2), material);
    if (!smooth) return;
    mesh.corner_normals.resize(mesh.triangles.size(), {kNoNormal, kNoNormal, kNoNormal});
    const auto first = static_cast<std::uint32_t>(mesh.normals.size());
    for (const Vec3d& normal : d) mesh.normals.emplace_back(normal);
    mesh.corner_normals.back() = {first, first + 1, first + 2};
  };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      if (i > 0) add({direction(i, j), direction(i, j + 1), direction(i + 1, j + 1)});
      if (i + 1 < n) add({direction(i, j), direction(i + 1, j + 1), direction(i + 1, j)});
    }
  }
  if (!mesh.corner_normals.empty()) {
    mesh.corner_normals.resize(mesh.triangles.size(), {kNoNormal, kNoNormal, kNoNormal});
  }
}

/// Five walls, open towards the camera, and two boxes: all of them matte.
inline SceneBuilder matte_room() {
  SceneBuilder b;
  const auto white = b.material(diffuse_material(Rgb(0.73F)));
  const auto red = b.material(diffuse_material({0.63F, 0.06F, 0.05F}));
  const auto green = b.material(diffuse_material({0.14F, 0.45F, 0.09F}));
  b.quad({Vec3f(-1, -1, -1), {-1, -1, 1}, {1, -1, 1}, {1, -1, -1}}, white);
  b.quad({Vec3f(-1, 1, -1), {1, 1, -1}, {1, 1, 1}, {-1, 1, 1}}, white);
  b.quad({Vec3f(-1, -1, -1), {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}}, white);
  b.quad({Vec3f(-1, -1, -1), {-1, 1, -1}, {-1, 1, 1}, {-1, -1, 1}}, red);
  b.quad({Vec3f(1, -1, -1), {1, -1, 1}, {1, 1, 1}, {1, 1, -1}}, green);
  b.box({0.1F, -1.0F, -0.1F}, {0.6F, -0.4F, 0.4F}, white);
  b.box({-0.7F, -1.0F, -0.6F}, {-0.2F, 0.2F, -0.1F}, white);
  b.camera({0.0F, 0.0F, 3.4F}, {0.0F, 0.0F, 0.0F}, {0, 1, 0}, 0.68F);
  return b;
}

/// Called for: diffuse reflection, a point light and its shadows.
inline EffectScene matte_point_light() {
  EffectScene s{"matte_point_light", matte_room(), {}};
  s.builder.point_light({0.0F, 0.8F, 0.3F}, Rgb(0.6F));
  s.settings.max_depth = 0;
  return s;
}

/// The Cornell box: matte walls and an area light.
inline EffectScene diffuse_cornell() {
  EffectScene s{"diffuse_cornell", matte_room(), {}};
  const auto lamp = s.builder.material(diffuse_material(Rgb(0.0F), {17.0F, 12.0F, 4.0F}));
  s.builder.quad({Vec3f(-0.25F, 0.99F, -0.25F),
                  {0.25F, 0.99F, -0.25F},
                  {0.25F, 0.99F, 0.25F},
                  {-0.25F, 0.99F, 0.25F}},
                 lamp);
  s.settings.max_depth = 8;
  return s;
}

/// Every effect of the seed: the mixed room with a sky, a translucent sheet and a smooth ball.
inline EffectScene everything() {
  EffectScene s{"everything", mixed_room(), {}};
  SceneBuilder& b = s.builder;
  Material sheet = diffuse_material(Rgb(0.6F));
  sheet.transparent = 1.0F;
  const auto translucent = b.material(sheet);
  b.quad({Vec3f(0.4F, 0.0F, -0.6F), {0.8F, 0.0F, -0.6F}, {0.8F, 0.5F, -0.6F}, {0.4F, 0.5F, -0.6F}},
         translucent);
  add_ball(b, {-0.45F, -0.6F, 0.35F}, 0.3F, 24, b.material(diffuse_material(Rgb(0.6F))), true);
  b.scene().background = {0.1F, 0.15F, 0.2F};
  return s;
}

/// All rows of the table: the room above with what it lacks.
inline EffectScene complete() {
  EffectScene s = everything();
  s.name = "complete";
  EffectJob job;
  for (const EffectRow* row : effect_table()) {
    if (effect_plan(s.settings, s.builder.scene()).called_for.contains(row->effect)) continue;
    const auto material = s.builder.material({});
    const auto i = static_cast<float>(row->effect);
    const Vec3f at(-0.9F + 0.1F * i, 0.5F, -0.9F);
    s.builder.box(at, at + Vec3f(0.09F, 0.2F, 0.2F), material);
    TriangleMesh& mesh = s.builder.scene().mesh;
    mesh.corner_normals.resize(mesh.triangles.size(), {kNoNormal, kNoNormal, kNoNormal});
    row->provoke({s.builder.scene(), job, material});
  }
  return s;
}

inline std::vector<EffectScene> named_effect_scenes() {
  return {matte_point_light(), diffuse_cornell(), everything()};
}

}  // namespace raykiln::render::support
