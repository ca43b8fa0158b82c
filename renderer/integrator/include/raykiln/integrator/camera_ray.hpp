// Rays from a pinhole camera through the pixels of a picture.
#pragma once

#include <cstdint>

#include "raykiln/math/ray.hpp"
#include "raykiln/sampling/random.hpp"
#include "raykiln/scene/scene.hpp"

namespace raykiln::render {

/// Where in its pixel a sample lies: uniform in it, or always in the middle.
enum class PixelMode : std::uint8_t { kRandom, kCentre };

/// A camera with the picture's shape worked in, for geometry that lies within `geometry`. Pixels are
/// square; the field of view is vertical.
class CameraRays {
 public:
  CameraRays(const Camera& camera, int width, int height, const Bounds3f& geometry);

  /// Unit direction through picture coordinates in pixels, (0, 0) at the top left corner.
  [[nodiscard]] Vec3f direction(double x, double y) const;

  /// Uses dimensions kPixelX and kPixelY of the path's first vertex in random mode.
  ///
  /// From an eye among the geometry the ray starts at the eye. From farther off it starts just before
  /// it gets to the geometry, at a point found in double: t counts from there, not from the eye, and
  /// rounding does not grow with the way that lies between. A ray that passes all geometry by is the
  /// single point t = 0 outside of it, which meets nothing.
  [[nodiscard]] Ray ray(int x, int y, PixelMode mode, const VertexKey& vertex) const;

 private:
  Vec3d eye_;
  Vec3d corner_;         ///< direction to picture coordinates (0, 0)
  Vec3d step_x_, step_y_;  ///< change of direction a pixel
  Vec3d lo_, hi_;        ///< of the geometry, with a margin; lo > hi if there is none
};

}  // namespace raykiln::render
