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

/// Where a reference goes: one that is not before the plane, or not behind it.
class SidesOf {
 public:
  enum : std::uint32_t { kBehind = 0, kBoth = 1, kPlanar = 2, kBefore = 3 };

#if defined(__AVX2__)
  // Both ends by one comparison: hi > p if not hi < the float after p. Of eight bits two are looked at.
  inline explicit SidesOf(const SplitQuery& q) : axis_(q.axis) {
    std::int32_t bits;
    __builtin_memcpy(&bits, &q.position, sizeof bits);
    const std::int32_t next_bits = q.position == 0.0F ? 1 : bits + (bits < 0 ? -1 : 1);
    float next;
    __builtin_memcpy(&next, &next_bits, sizeof next);
    for (int k = 0; k < 4; ++k) plane_[k] = q.position;
    for (int k = 4; k < 8; ++k) plane_[k] = next;
  }
  inline std::uint32_t of(const HeldReference& held, ReferenceWords) const {
    const int below = _mm256_movemask_ps(_mm256_cmp_ps(held.part[0], plane_, _CMP_LT_OQ));
    const std::uint32_t ends = static_cast<std::uint32_t>(below) >> axis_;
    return (ends & 1U) | (ends >> 3 & 2U);
  }

 private:
  std::uint32_t axis_;
  Floats plane_;
#else
  inline explicit SidesOf(const SplitQuery& q) : axis_(q.axis), position_(q.position) {}
  inline std::uint32_t of(const HeldReference&, ReferenceWords from) const {
    return (from[axis_] < position_ ? 1U : 0U) | (from[axis_ + 4] > position_ ? 0U : 2U);
  }

 private:
  std::uint32_t axis_;
  float position_;
#endif
};

// Everything is written to both sides and kept where it counts: no branch to mispredict. A triangle
// on neither side of the plane lies in it.
void split_references(const SplitQuery& query, ReferenceWords from, std::uint32_t n, float* left,
                      float* right, SplitCounts& result) {
  const SidesOf sides(query);
  constexpr std::uint64_t kLeft = 1, kRight = std::uint64_t{1} << 32;  // how many so far
  const std::uint64_t more[4] = {kRight, kLeft + kRight, query.planar_left != 0 ? kLeft : kRight, kLeft};
  std::uint64_t places = 0;
  std::uint32_t n_both = 0;
  for (std::uint32_t i = 0; i < n; ++i, from += 8) {
    const HeldReference held(from);
    const std::uint32_t side = sides.of(held, from);
    const auto to_left = static_cast<std::uint32_t>(places), to_right = static_cast<std::uint32_t>(places >> 32);
    held.write(left + 8 * std::size_t{to_left});
    held.write(right + 8 * std::size_t{to_right});
    result.both[n_both] = {to_left, to_right};
    places += more[side];
    n_both += side == SidesOf::kBoth ? 1U : 0U;
  }
  result.left = static_cast<std::uint32_t>(places);
  result.right = static_cast<std::uint32_t>(places >> 32);
  result.n_both = n_both;
}

}  // namespace
}  // namespace raykiln::render
