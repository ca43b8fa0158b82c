// Choosing Scene::origin.
#pragma once

#include "raykiln/math/vec.hpp"

namespace raykiln::render::io {

/// Closed box in double precision.
struct Bounds3d {
  Vec3d lo, hi;
};

/// (0, 0, 0) while the largest |coordinate| is at most twice the largest side of the box. Otherwise
/// the centre of the box, rounded to a multiple of the largest power of two that is no larger than
/// that side: then subtracting it is exact for every coordinate that has digits to lose, and a scene
/// scaled by a power of two keeps its bits.
[[nodiscard]] Vec3d choose_origin(const Bounds3d& bounds);

}  // namespace raykiln::render::io
