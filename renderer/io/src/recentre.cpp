#include "recentre.hpp"

#include <algorithm>
#include <cmath>

namespace raykiln::render::io {
namespace {

double largest(const Vec3d& v) { return std::max({v.x, v.y, v.z}); }

}  // namespace

Vec3d choose_origin(const Bounds3d& bounds) {
  const double side = largest(bounds.hi - bounds.lo);
  const double far = largest(glm::max(glm::abs(bounds.lo), glm::abs(bounds.hi)));
  if (far <= 2.0 * side) return Vec3d(0.0);
  const Vec3d centre = bounds.lo + 0.5 * (bounds.hi - bounds.lo);
  if (!(side > 0.0)) return centre;  // a single point: nothing will be left of it
  const double step = std::ldexp(1.0, std::ilogb(side));
  return Vec3d(std::round(centre.x / step), std::round(centre.y / step),
               std::round(centre.z / step)) *
         step;
}

}  // namespace raykiln::render::io
