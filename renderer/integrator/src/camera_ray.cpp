#include "raykiln/integrator/camera_ray.hpp"

#include <algorithm>
#include <cmath>

#include "raykiln/math/float_bits.hpp"
#include "raykiln/sampling/warp.hpp"

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
    : camera_(camera), lo_(geometry.lo), hi_(geometry.hi) {
  const bool parallel = camera.projection == Projection::kOrthographic;
  const double pixel =
      parallel ? camera.view_height / height : 2.0 * std::tan(0.5 * camera.fov_y_rad) / height;
  step_x_ = pixel * camera.right;
  step_y_ = -pixel * camera.up;
  corner_ = parallel ? -0.5 * width * step_x_ : camera.forward - 0.5 * width * step_x_;
  corner_ -= 0.5 * height * step_y_;
  if (geometry.empty()) return;
  const double coordinate = std::max(largest_component(lo_), largest_component(hi_));
  double reach = largest_component(camera.eye) + camera.lens.radius;
  if (parallel) reach += length(corner_);
  const double margin = 4.0 * kFloatUnit * coordinate + 16.0 * 0x1p-53 * reach;
  lo_ -= Vec3d(margin);
  hi_ += Vec3d(margin);
}

CameraRays::Sight CameraRays::sight(double x, double y) const {
  const Vec3d way = corner_ + x * step_x_ + y * step_y_;
  if (camera_.projection == Projection::kPerspective) return {camera_.eye, normalize(way)};
  return {camera_.eye + way, camera_.forward};
}

// A ray through the middle of a thin lens is not bent, and all rays of a pixel meet where that one meets
// the plane in focus. In perspective `way` goes 1 along forward.
CameraRays::Sight CameraRays::through_lens(double x, double y, const VertexKey& vertex) const {
  const DiskPoint at = sample_uniform_disk(uniform(vertex, Dimension::kLensX), uniform(vertex, Dimension::kLensY));
  const Vec3d aside = camera_.lens.radius * (at.x * camera_.right + at.y * camera_.up);
  const Vec3d way = corner_ + x * step_x_ + y * step_y_;
  const double focus = camera_.lens.focus_distance;
  if (camera_.projection == Projection::kPerspective) {
    return {camera_.eye + aside, normalize(focus * way - aside)};
  }
  return {camera_.eye + way + aside, normalize(focus * camera_.forward - aside)};
}

Vec3f CameraRays::direction(double x, double y) const { return Vec3f(sight(x, y).towards); }

std::optional<CameraRays::Pinhole> CameraRays::pinhole() const {
  if (camera_.projection != Projection::kPerspective || camera_.lens.radius > 0.0) return std::nullopt;
  return Pinhole{camera_.eye, corner_, step_x_, step_y_, lo_, hi_};
}

PathCone CameraRays::cone(const Ray& ray) const {
  const double pixel = length(step_x_);
  if (camera_.projection == Projection::kOrthographic) return {pixel, 0.0};
  return {pixel * std::max(depth(Vec3d(ray.o)), 0.0), pixel * dot(normalize(Vec3d(ray.d)), camera_.forward)};
}

Ray CameraRays::ray(int x, int y, PixelMode mode, const VertexKey& vertex, PixelFilter filter) const {
  const bool random = mode == PixelMode::kRandom;
  const double dx = random ? filtered_offset(filter, uniform(vertex, Dimension::kPixelX)) : 0.5;
  const double dy = random ? filtered_offset(filter, uniform(vertex, Dimension::kPixelY)) : 0.5;
  const Sight s =
      camera_.lens.radius > 0.0 ? through_lens(x + dx, y + dy, vertex) : sight(x + dx, y + dy);
  Ray ray;
  ray.d = Vec3f(s.towards);
  const double distance = entry(s.from, s.towards, lo_, hi_);
  ray.o = Vec3f(distance > 0.0 ? s.from + distance * s.towards : s.from);
  if (distance < 0.0) ray.t_max = 0.0F;
  return ray;
}

}  // namespace raykiln::render
