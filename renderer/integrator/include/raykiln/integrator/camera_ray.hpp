// Rays from a camera through the pixels of a picture.
#pragma once

#include <cstdint>
#include <optional>

#include "raykiln/math/ray.hpp"
#include "raykiln/sampling/random.hpp"
#include "raykiln/scene/scene.hpp"

namespace raykiln::render {

/// Where in its pixel a sample lies: uniform in it, or always in the middle.
enum class PixelMode : std::uint8_t { kRandom, kCentre };

/// What random samples of a pixel are the mean over. Samples are drawn from the filter and all count
/// alike (filter importance sampling, Ernst et al. 2006), so each belongs to one pixel.
enum class PixelFilter : std::uint8_t {
  kBox,             ///< the pixel
  kBlackmanHarris,  ///< the window of Blackman and Harris in x and in y, 3 pixels wide
};

/// Where the filter's share u of [0, 1) ends, in pixels from the pixel's edge: [0, 1) for the box,
/// [-1, 2] else.
[[nodiscard]] double filtered_offset(PixelFilter filter, double u);

/// What a path's pixel covers across its ray, metres: so much at the ray's start, and more with each metre.
struct PathCone {
  double width = 0.0;
  double spread = 0.0;
};

/// A camera with the picture's shape worked in, for geometry that lies within `geometry`. Pixels are
/// square; the field of view is vertical.
class CameraRays {
 public:
  CameraRays(const Camera& camera, int width, int height, const Bounds3f& geometry);

  /// Unit direction through picture coordinates in pixels, (0, 0) at the top left corner, of the ray
  /// through the middle of the lens.
  [[nodiscard]] Vec3f direction(double x, double y) const;

  /// Metres from the eye to `place` along the camera's forward.
  [[nodiscard]] double depth(const Vec3d& place) const { return dot(place - camera_.eye, camera_.forward); }

  /// Of a ray of this camera: as wide as a pixel, through the middle of the lens.
  [[nodiscard]] PathCone cone(const Ray& ray) const;

  /// Uses dimensions kPixelX and kPixelY of the path's first vertex in random mode, kLensX and kLensY
  /// where there is a lens.
  ///
  /// From an eye among the geometry the ray starts at the eye. From farther off it starts just before
  /// it gets to the geometry, at a point found in double: t counts from there, not from the eye, and
  /// rounding does not grow with the way that lies between. A ray that passes all geometry by is the
  /// single point t = 0 outside of it, which meets nothing.
  [[nodiscard]] Ray ray(int x, int y, PixelMode mode, const VertexKey& vertex,
                        PixelFilter filter = PixelFilter::kBox) const;

  /// What ray() reads of a camera in perspective without a lens; nothing for others.
  struct Pinhole {
    Vec3d eye, corner, step_x, step_y, lo, hi;
  };
  [[nodiscard]] std::optional<Pinhole> pinhole() const;

 private:
  struct Sight {
    Vec3d from, towards;  ///< a place and a unit direction
  };
  [[nodiscard]] Sight sight(double x, double y) const;
  [[nodiscard]] Sight through_lens(double x, double y, const VertexKey& vertex) const;

  Camera camera_;
  /// To picture coordinates (0, 0) and a pixel on: directions; of an orthographic camera places from the eye.
  Vec3d corner_, step_x_, step_y_;
  Vec3d lo_, hi_;        ///< of the geometry, with a margin; lo > hi if there is none
};

}  // namespace raykiln::render
