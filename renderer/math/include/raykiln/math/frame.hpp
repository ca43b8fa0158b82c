// Orthonormal frame about a unit vector (Duff et al. 2017, "Building an Orthonormal Basis,
// Revisited", listing 3): no branch cut but the sign of n.z, no division by a small number.
#pragma once

#include <cmath>

#include "raykiln/math/vec.hpp"

namespace raykiln::render {

struct Frame {
  Vec3f s, t, n;  ///< right-handed, unit, mutually orthogonal

  explicit Frame(const Vec3f& unit_n) : s(), t(), n(unit_n) {
    const float sign = std::copysign(1.0F, n.z);
    const float a = -1.0F / (sign + n.z);
    const float b = n.x * n.y * a;
    s = Vec3f(1.0F + sign * n.x * n.x * a, sign * b, -sign * n.x);
    t = Vec3f(b, sign + n.y * n.y * a, -n.y);
  }
  [[nodiscard]] Vec3f to_world(const Vec3f& local) const {
    return local.x * s + local.y * t + local.z * n;
  }
  [[nodiscard]] Vec3f to_local(const Vec3f& world) const {
    return {dot(world, s), dot(world, t), dot(world, n)};
  }
};

}  // namespace raykiln::render
