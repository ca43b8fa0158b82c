// Splitting a cell: references to the sides where they lie.
#pragma once

#include "build_kernel_lanes.hpp"

namespace raykiln::render {
namespace {

/// A reference in registers.
struct HeldReference {
  Floats part[8 / kLanes];

  inline explicit HeldReference(ReferenceWords from) {
    for (int i = 0; i < 8 / kLanes; ++i) part[i] = lanes_at<Floats>(from + kLanes * i);
  }
  inline void write(float* to) const { __builtin_memcpy(to, part, sizeof part); }
};

// Everything is written to both sides and kept where it counts: no branch to mispredict. A triangle
// on neither side of the plane lies in it.
void split_references(const SplitQuery& query, ReferenceWords from, std::uint32_t n, float* left,
                      float* right, SplitCounts& result) {
  const SplitQuery q = query;
  std::uint32_t n_left = 0;
  std::uint32_t n_right = 0;
  std::uint32_t n_both = 0;
  for (std::uint32_t i = 0; i < n; ++i, from += 8) {
    const HeldReference held(from);
    const std::uint32_t before = from[q.axis] < q.position ? 1U : 0U;
    const std::uint32_t behind = from[q.axis + 4] > q.position ? 1U : 0U;
    const std::uint32_t planar = (before | behind) ^ 1U;
    held.write(left + 8 * std::size_t{n_left});
    held.write(right + 8 * std::size_t{n_right});
    result.both[n_both] = {n_left, n_right};
    n_left += before | (planar & q.planar_left);
    n_right += behind | (planar & ~q.planar_left);
    n_both += before & behind;
  }
  result.left = n_left;
  result.right = n_right;
  result.n_both = n_both;
}

}  // namespace
}  // namespace raykiln::render
