// Closed rooms with random things in them: every kind of surface and light at once.
#pragma once

#include <cmath>

#include "hard/support/members.hpp"
#include "raykiln/render/render.hpp"
#include "raykiln/selftest/small_scene.hpp"

namespace raykiln::hard {

inline render::Material random_material(Members& members) {
  const auto part = [&] { return static_cast<float>(members.between(0.0, 0.45)); };
  render::Material material;
  const double kind = members.between(0.0, 5.0);
  if (kind < 1.0) {  // glass, sharp
    material.specular = render::Rgb(0.95F);
    material.specular_exp = 1e10;
    material.transparent = 1.0F;
    material.index_of_refraction = static_cast<float>(members.between(1.1, 2.4));
    return material;
  }
  material.diffuse = {part(), part(), part()};
  if (kind < 2.0) return material;
  material.specular = {part(), part(), part()};
  material.specular_exp = members.scale(1.0, 1e6);
  if (kind > 4.0) material.transparent = 0.5F;
  return material;
}

/// The room [-1, 1]^3 with coloured walls, `boxes` boxes, `loose` loose triangles, an emitting square
/// and two point lights. Seen from inside. All triangles in general position but for the walls'.
inline render::Scene random_room(Members& members, int boxes = 3, int loose = 24) {
  using render::Vec3f;
  render::selftest::SmallScene s;
  const auto at = [&](double reach) {
    const auto one = [&] { return static_cast<float>(members.between(-reach, reach)); };
    const float x = one(), y = one();
    return Vec3f(x, y, one());
  };
  render::Material wall = render::selftest::matte(0.5F);
  wall.diffuse = {0.6F, 0.5F, 0.3F};
  s.box(Vec3f(-1), Vec3f(1), s.material(wall), true);
  render::Material lamp = render::selftest::matte(0.1F);
  lamp.emission = {5.0F, 4.0F, 7.0F};
  const float height = static_cast<float>(members.between(0.8, 0.95));
  s.level_square(0.3F, height, s.material(lamp), false);
  for (int i = 0; i < boxes; ++i) {
    const Vec3f lo = at(0.6), size = 0.1F + glm::abs(at(0.25));
    s.box(lo, lo + size, s.material(random_material(members)));
  }
  for (int i = 0; i < loose; ++i) {
    const Vec3f centre = at(0.8);
    const auto material = s.material(random_material(members));
    s.triangle(centre + at(0.15), centre + at(0.15), centre + at(0.15), material);
  }
  s.point_light({-0.71F, 0.43F, 0.67F}, {0.3F, 0.2F, 0.1F});
  s.point_light({0.55F, -0.81F, 0.37F}, {0.1F, 0.4F, 0.2F});
  s.look({-0.9, 0.83, 0.1}, {0.3, -0.2, -0.1}, {0, 0, 1}, 1.3);
  return s.scene();
}

inline render::RenderSettings room_settings(std::uint64_t seed, const render::LightModel& model) {
  render::RenderSettings settings;
  settings.width = 24;
  settings.height = 18;
  settings.max_depth = 6;
  settings.light_model = model;
  settings.seed = seed;
  return settings;
}

}  // namespace raykiln::hard
