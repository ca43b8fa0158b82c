// Polygons to triangles.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "raykiln/math/vec.hpp"

namespace raykiln::render::io {

enum class PolygonStatus {
  kGood,
  kCrossing,      ///< no ear was left: self-intersecting or flat; the rest became a fan
  kTooManyToClip  ///< concave with more than kMaxConcaveCorners corners; nothing was written
};

/// Ear clipping takes O(n^2) steps, so that the corners of one concave polygon need a bound.
inline constexpr std::size_t kMaxConcaveCorners = 1024;

/// Writes n - 2 triangles (indices into `corners`, same winding) to `triangles`. Convex polygons
/// become a fan from the first corner; concave ones are cut by ear clipping in the plane in which
/// the polygon's Newell normal is longest. n >= 3.
[[nodiscard]] PolygonStatus triangulate(std::span<const Vec3d> corners,
                                        std::vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace raykiln::render::io
