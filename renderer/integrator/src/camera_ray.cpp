#include "raykiln/integrator/camera_ray.hpp"

#include <algorithm>
#include <cmath>

#include "raykiln/math/float_bits.hpp"

namespace raykiln::render {
namespace {

double largest_component(const Vec3d& v) {
  const Vec3d a = abs(v);
  return std::max({a.x, a.y, a.z});
}

/// Distance at which a ray from outside enters the box lo .. hi; negative if it never does.
double entry(const Vec3d& eye, const Vec3d& direction, const Vec3d& lo, const Vec3d& hi) {
  double enter = 0.0, leave = std::numeric_limits<double>::infinity();
  for (int a = 0; a < 3; ++a) {
    if (direction[a] == 0.0) {
      if (!(lo[a] <= eye[a] && eye[a] <= hi[a])) return -1.0;
      continue;
    }
    const double t0 = (lo[a] - eye[a]) / direction[a];
    const double t1 = (hi[a] - eye[a]) / direction[a];
    enter = std::max(enter, std::min(t0, t1));
    leave = std::min(leave, std::max(t0, t1));
  }
  return enter <= leave ? enter : -1.0;
}

}  // namespace

// The margin keeps a start outside of the geometry. With M the geometry's largest coordinate and
// E the eye's, u = 2^-24 and w = 2^-53: the point of entry is computed with an error below 4 w (E + M),
// and rounding it to float moves it by at most u (M + margin) along each axis. 2 u M + 8 w E is more
// than both; twice that leaves room for the roundings of the margin itself.
CameraRays::CameraRays(const Camera& camera, int width, int height, const Bounds3f& geometry)
    : eye_(camera.eye), lo_(geometry.lo), hi_(geometry.hi) {
  const double pixel = 2.0 * std::tan(0.5 * camera.fov_y_rad) / height;
  step_x_ = pixel * camera.right;
  step_y_ = -pixel * camera.up;
  corner_ = camera.forward - 0.5 * width * step_x_ - 0.5 * height * step_y_;
  if (geometry.empty()) return;
  const double coordinate = std::max(largest_component(lo_), largest_component(hi_));
  const double margin =
      4.0 * kFloatUnit * coordinate + 16.0 * 0x1p-53 * largest_component(eye_);
  lo_ -= Vec3d(margin);
  hi_ += Vec3d(margin);
}

Vec3f CameraRays::direction(double x, double y) const {
  return Vec3f(normalize(corner_ + x * step_x_ + y * step_y_));
}

Ray CameraRays::ray(int x, int y, PixelMode mode, const VertexKey& vertex) const {
  const bool random = mode == PixelMode::kRandom;
  const double dx = random ? uniform(vertex, Dimension::kPixelX) : 0.5;
  const double dy = random ? uniform(vertex, Dimension::kPixelY) : 0.5;
  const Vec3d d = normalize(corner_ + (x + dx) * step_x_ + (y + dy) * step_y_);
  Ray ray;
  ray.d = Vec3f(d);
  const double distance = entry(eye_, d, lo_, hi_);
  ray.o = Vec3f(distance > 0.0 ? eye_ + distance * d : eye_);
  if (distance < 0.0) ray.t_max = 0.0F;
  return ray;
}

}  // namespace raykiln::render
