// Exact test for triangles without area.
#pragma once

#include "raykiln/math/vec.hpp"

namespace raykiln::render::io {

/// True exactly when the three float points lie on one line in real arithmetic: a sliver that is
/// thin but has an area is kept. Finite input with |x| <= 1e18.
[[nodiscard]] bool has_zero_area(const Vec3f& a, const Vec3f& b, const Vec3f& c);

}  // namespace raykiln::render::io
