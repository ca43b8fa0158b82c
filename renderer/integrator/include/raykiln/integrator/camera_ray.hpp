// Rays from a pinhole camera through the pixels of a picture.
#pragma once

#include <cstdint>

#include "raykiln/math/ray.hpp"
#include "raykiln/sampling/random.hpp"
#include "raykiln/scene/scene.hpp"

namespace raykiln::render {

/// Where in its pixel a sample lies: uniform in it, or always in the middle.
enum class PixelMode : std::uint8_t { kRandom, kCentre };

/// A camera with the picture's shape worked in. Pixels are square; the field of view is vertical.
class CameraRays {
 public:
  CameraRays(const Camera& camera, int width, int height);

  /// Unit direction through picture coordinates in pixels, (0, 0) at the top left corner.
  [[nodiscard]] Vec3f direction(double x, double y) const;

  /// Uses dimensions kPixelX and kPixelY of the path's first vertex in random mode.
  [[nodiscard]] Ray ray(int x, int y, PixelMode mode, const VertexKey& vertex) const;

 private:
  Vec3f eye_;
  Vec3d corner_;         ///< direction to picture coordinates (0, 0)
  Vec3d step_x_, step_y_;  ///< change of direction a pixel
};

}  // namespace raykiln::render
