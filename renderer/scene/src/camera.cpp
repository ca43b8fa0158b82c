#include "raykiln/scene/camera.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace raykiln::render {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kSmallestSine = 1e-6;

bool finite(const Vec3d& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

// Scaled by its largest component first: the squares of huge or tiny ones leave the range.
std::optional<Vec3d> unit(const Vec3d& v) {
  const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  if (!finite(v) || !(largest > 0.0)) return std::nullopt;
  return normalize(v / largest);
}

}  // namespace

std::optional<Camera> make_camera(std::string name, const Vec3d& eye, const Vec3d& forward,
                                  const Vec3d& up, double fov_y_rad, const Vec3d& origin) {
  const auto f = unit(forward);
  const auto u = unit(up);
  if (!f || !u || !finite(eye) || !(fov_y_rad > 0.0 && fov_y_rad < kPi)) return std::nullopt;
  const Vec3d side = cross(*f, *u);
  if (!(length(side) > kSmallestSine)) return std::nullopt;
  const Vec3d right = normalize(side);
  Camera camera;
  camera.name = std::move(name);
  camera.eye = eye - origin;
  camera.right = right;
  camera.up = cross(right, *f);
  camera.forward = *f;
  camera.fov_y_rad = fov_y_rad;
  return camera;
}

}  // namespace raykiln::render
