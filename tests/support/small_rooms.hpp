// Small rooms of 2 m, seen from inside, whose errors are measured over many seeds.
#pragma once

#include "support/scene_pieces.hpp"

namespace raykiln::render::support {

inline constexpr Rgb kLampLight{6.0F, 5.0F, 4.0F};

/// A level square about (x, y, z).
inline void level_quad(SceneBuilder& b, const Vec3f& at, float half, std::uint32_t material) {
  b.quad({at + Vec3f(-half, 0, -half), at + Vec3f(half, 0, -half), at + Vec3f(half, 0, half), at + Vec3f(-half, 0, half)},
         material);
}

/// White walls; the ceiling is open above the square |x|, |z| <= hole.
inline SceneBuilder white_room(float hole = 0.0F) {
  SceneBuilder b;
  const auto white = b.material(diffuse_material(Rgb(0.6F)));
  b.quad({Vec3f(-1, -1, -1), {-1, -1, 1}, {1, -1, 1}, {1, -1, -1}}, white);
  b.quad({Vec3f(-1, -1, -1), {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}}, white);
  b.quad({Vec3f(-1, -1, 1), {-1, 1, 1}, {1, 1, 1}, {1, -1, 1}}, white);
  b.quad({Vec3f(-1, -1, -1), {-1, 1, -1}, {-1, 1, 1}, {-1, -1, 1}}, white);
  b.quad({Vec3f(1, -1, -1), {1, -1, 1}, {1, 1, 1}, {1, 1, -1}}, white);
  const float h = hole;
  b.quad({Vec3f(-1, 1, -1), {1, 1, -1}, {1, 1, -h}, {-1, 1, -h}}, white);
  b.quad({Vec3f(-1, 1, h), {1, 1, h}, {1, 1, 1}, {-1, 1, 1}}, white);
  if (h > 0.0F) {
    b.quad({Vec3f(-1, 1, -h), {-h, 1, -h}, {-h, 1, h}, {-1, 1, h}}, white);
    b.quad({Vec3f(h, 1, -h), {1, 1, -h}, {1, 1, h}, {h, 1, h}}, white);
  }
  b.camera({0.0F, 0.0F, 0.95F}, {0.0F, -0.3F, -1.0F}, {0, 1, 0}, 1.1F);
  return b;
}

inline void red_box(SceneBuilder& b) {
  b.box({-0.6F, -0.99F, -0.6F}, {-0.1F, -0.2F, -0.1F}, b.material(diffuse_material({0.7F, 0.2F, 0.1F})));
}

/// The lamp fills a hole of the ceiling.
inline SceneBuilder diffuse_with_area_light() {
  SceneBuilder b = white_room(0.3F);
  level_quad(b, {0, 1, 0}, 0.3F, b.material(diffuse_material(Rgb(0.0F), kLampLight)));
  red_box(b);
  return b;
}

/// The lamp hangs 1 cm below the ceiling and shines upwards too: half of its light leaves through a slit
/// that one path in a thousand finds, 50 times as bright as the room.
inline SceneBuilder lamp_over_a_slit() {
  SceneBuilder b = white_room();
  level_quad(b, {0, 0.99F, 0}, 0.3F, b.material(diffuse_material(Rgb(0.0F), kLampLight)));
  red_box(b);
  return b;
}

inline SceneBuilder glass_with_caustic() {
  SceneBuilder b = white_room();
  level_quad(b, {0, 0.99F, 0}, 0.3F, b.material(diffuse_material(Rgb(0.0F), kLampLight)));
  b.box({-0.3F, -0.9F, -0.5F}, {0.3F, -0.3F, 0.1F}, b.material(glass_material(1.5F, 1e10)));
  return b;
}

/// 36 lamps of 2 cm, 2 cm below the ceiling, and as many point lights.
inline SceneBuilder many_small_lights() {
  SceneBuilder b = white_room();
  const auto lamp = b.material(diffuse_material(Rgb(0.0F), {200.0F, 150.0F, 100.0F}));
  for (int i = 0; i < 36; ++i) {
    const float x = -0.8F + 0.3F * static_cast<float>(i % 6), z = -0.8F + 0.3F * static_cast<float>(i / 6);
    level_quad(b, {x + 0.01F, 0.98F, z + 0.01F}, 0.01F, lamp);
    b.point_light({z, 0.3F, x}, Rgb(0.01F));
  }
  return b;
}

}  // namespace raykiln::render::support
