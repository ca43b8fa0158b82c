// A ray and an axis-aligned box.
#pragma once

#include <limits>

#include "raykiln/math/vec.hpp"

namespace raykiln::render {

/// Points o + t d with t_min <= t <= t_max. `d` need not be unit length; t counts in units of |d|.
/// 32 bytes, in the order in which ray files are written: o, t_min, d, t_max.
struct Ray {
  Vec3f o{0.0F};
  float t_min = 0.0F;
  Vec3f d{0.0F, 0.0F, 1.0F};
  float t_max = std::numeric_limits<float>::infinity();
};
static_assert(sizeof(Ray) == 32);

/// Closed box; empty when lo > hi on any axis.
struct Bounds3f {
  Vec3f lo{std::numeric_limits<float>::infinity()};
  Vec3f hi{-std::numeric_limits<float>::infinity()};

  void grow(const Vec3f& p) {
    lo = glm::min(lo, p);
    hi = glm::max(hi, p);
  }
  [[nodiscard]] bool empty() const { return !(lo.x <= hi.x && lo.y <= hi.y && lo.z <= hi.z); }
};

}  // namespace raykiln::render
