// What the builder carries through the cells: a triangle and the box of its part in the cell.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "raykiln/math/ray.hpp"

namespace raykiln::render {

/// 32 bytes. Coordinates are finite, never -0, and lie in the cell; an axis with lo == hi makes the
/// triangle planar there.
struct alignas(16) Reference {
  std::array<float, 3> lo;
  std::uint32_t triangle;  ///< id in the mesh; ascending within a cell
  std::array<float, 3> hi;
  std::uint32_t unused;
};
static_assert(sizeof(Reference) == 32);

/// As the kernels read them (build_kernels.hpp).
[[nodiscard]] inline const float* words_of(const Reference* r) { return r->lo.data(); }
[[nodiscard]] inline float* words_of(Reference* r) { return r->lo.data(); }

/// A cell's references, in order, in one or more runs.
using Runs = std::span<const std::span<const Reference>>;

[[nodiscard]] inline Reference make_reference(const Bounds3f& box, std::uint32_t triangle) {
  Reference r{};
  for (std::size_t k = 0; k < 3; ++k) {
    r.lo[k] = box.lo[static_cast<int>(k)] + 0.0F;  // -0 becomes +0
    r.hi[k] = box.hi[static_cast<int>(k)] + 0.0F;
  }
  r.triangle = triangle;
  return r;
}

}  // namespace raykiln::render
