// Scenes of a few triangles put together by hand.
#pragma once

#include <array>
#include <utility>

#include "raykiln/scene/scene.hpp"

namespace raykiln::render::selftest {

inline Material matte(float albedo, float emission = 0.0F) {
  Material material;
  material.diffuse = Rgb(albedo);
  material.emission = Rgb(emission);
  return material;
}

/// A body of this index that neither absorbs nor blurs: the lobe is 1e-7 rad wide.
inline Material clear_glass(float index) {
  Material material;
  material.specular = Rgb(1.0F);
  material.specular_exp = 1e15;
  material.transparent = 1.0F;
  material.index_of_refraction = index;
  return material;
}

class SmallScene {
 public:
  std::uint32_t material(const Material& material) {
    scene_.materials.push_back(material);
    return static_cast<std::uint32_t>(scene_.materials.size() - 1);
  }

  void triangle(const Vec3f& a, const Vec3f& b, const Vec3f& c, std::uint32_t material) {
    const auto first = static_cast<std::uint32_t>(scene_.mesh.positions.size());
    for (const Vec3f& p : {a, b, c}) {
      scene_.mesh.positions.push_back(p);
      scene_.bounds.grow(p);
    }
    scene_.mesh.triangles.push_back({first, first + 1, first + 2});
    scene_.mesh.material_ids.push_back(material);
  }

  /// Corners counter-clockwise seen from the side that the normal faces.
  void quad(const std::array<Vec3f, 4>& p, std::uint32_t material) {
    triangle(p[0], p[1], p[2], material);
    triangle(p[0], p[2], p[3], material);
  }

  /// |x|, |y| <= half at height z; its normal faces up, or down.
  void level_square(float half, float z, std::uint32_t material, bool up = true) {
    const Vec3f a(-half, -half, z), b(half, -half, z), c(half, half, z), d(-half, half, z);
    if (up) {
      quad({a, b, c, d}, material);
    } else {
      quad({d, c, b, a}, material);
    }
  }

  /// Axis-parallel box; normals face outwards, or inwards for a room.
  void box(const Vec3f& lo, const Vec3f& hi, std::uint32_t material, bool inwards = false) {
    constexpr std::array<std::array<unsigned, 4>, 6> kFaces{
        {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
    const auto corner = [&](unsigned i) {
      return Vec3f((i & 1U) != 0 ? hi.x : lo.x, (i & 2U) != 0 ? hi.y : lo.y,
                   (i & 4U) != 0 ? hi.z : lo.z);
    };
    for (const auto& f : kFaces) {
      std::array<Vec3f, 4> p{corner(f[0]), corner(f[1]), corner(f[2]), corner(f[3])};
      if (inwards) std::swap(p[1], p[3]);
      quad(p, material);
    }
  }

  void point_light(const Vec3f& position, const Rgb& intensity) {
    scene_.point_lights.push_back({.name = "", .position = position, .intensity = intensity});
  }

  /// Replaces all cameras. `up` must not be parallel to the view; the angle is the vertical one.
  void look(const Vec3d& eye, const Vec3d& target, const Vec3d& up, double fov_y_rad) {
    Camera camera;
    const Vec3d forward = normalize(target - eye), right = normalize(cross(forward, up));
    camera.eye = eye;
    camera.forward = forward;
    camera.right = right;
    camera.up = cross(right, forward);
    camera.fov_y_rad = fov_y_rad;
    scene_.cameras = {camera};
  }

  Scene& scene() { return scene_; }
  [[nodiscard]] const Scene& scene() const { return scene_; }

 private:
  Scene scene_;
};

}  // namespace raykiln::render::selftest
