// The part of a triangle inside a box ("perfect splits").
#pragma once

#include <array>
#include <optional>

#include "raykiln/math/ray.hpp"

namespace raykiln::render {

/// Bounds of the triangle's part in the closed cell: clipped in double from the original corners
/// (so errors do not add up from level to level), rounded outwards to float, then clamped to the
/// cell. Empty when the part is empty. The corners are finite. The builder clips for both parts of a
/// cell at once (kernel_clip.hpp) and gets the same.
[[nodiscard]] std::optional<Bounds3f> clipped_bounds(const std::array<Vec3f, 3>& corners,
                                                     const Bounds3f& cell);

}  // namespace raykiln::render
