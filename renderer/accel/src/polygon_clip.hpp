// The part of a triangle inside a box ("perfect splits").
#pragma once

#include <array>
#include <optional>

#include "raykiln/math/ray.hpp"
#include "reference.hpp"

namespace raykiln::render {

/// Bounds of the triangle's part in the closed cell: clipped in double from the original corners
/// (so errors do not add up from level to level), rounded outwards to float, then clamped to the
/// cell. Empty when the part is empty. The corners are finite.
[[nodiscard]] std::optional<Bounds3f> clipped_bounds(const std::array<Vec3f, 3>& corners,
                                                     const Bounds3f& cell);

/// Gives the bounds of triangles in both parts of a cell that was split, each that of clipped_bounds.
class PartsClip {
 public:
  PartsClip(const Bounds3f& left_cell, const Bounds3f& right_cell, int axis);

  /// Which parts are not empty.
  struct Found {
    bool left = false, right = false;
  };
  /// Writes the boxes of those, and a zero behind each end of them.
  Found run(const std::array<Vec3f, 3>& corners, Reference& left, Reference& right) const;

  /// A box as the clipping needs it: x, y, z and a zero.
  struct Cell {
    explicit Cell(const Bounds3f& box);
    alignas(16) std::array<float, 4> lo{}, hi{};
  };

 private:
  std::size_t axis_;
  Cell left_, right_;
};

}  // namespace raykiln::render
