// Which parts of a scene can matter: found by one walk over its triangles and lights.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "raykiln/scene/scene.hpp"

namespace raykiln::render {

/// No channel above 0.
[[nodiscard]] inline bool is_black(const Rgb& c) {
  return !(c.x > 0.0F || c.y > 0.0F || c.z > 0.0F);
}

struct SceneUse {
  std::vector<std::uint32_t> materials;  ///< ids that a triangle has, ascending
  /// Those with power above 0.
  std::uint64_t shining_point_lights = 0, shining_spot_lights = 0, shining_directional_lights = 0;
  bool environment_shines = false;  ///< there is a map, and some texel is not black
  /// First triangle that reflects and whose normal, interpolated, may differ from that of its
  /// plane.
  std::optional<std::uint32_t> smooth_triangle{};

  /// Lights that no ray can find.
  [[nodiscard]] std::uint64_t lights_without_surface() const {
    return shining_point_lights + shining_spot_lights + shining_directional_lights;
  }
};

/// O(triangles + materials + lights + texels of the environment). Once a scene: a plan is made for every tile.
[[nodiscard]] SceneUse use_of(const Scene& scene);

/// Frees what no job can make use of: normals that are nowhere interpolated to anything else than
/// the plane's. Changes no picture.
void drop_unused(Scene& scene);

}  // namespace raykiln::render
