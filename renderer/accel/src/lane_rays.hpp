// What leaves know of rays in lanes. Internal linkage only.
#pragma once

#include <cstddef>
#include <cstdint>

namespace raykiln::render {
namespace {

constexpr float kEndless = __builtin_inff();

/// What leaves need to know of rays, a lane each; part of LaneGroup and ReadyRays.
template <std::size_t kW>
struct alignas(64) LeafRays {
  float o[3][kW], inv_d[3][kW];
  float sx[kW], sy[kW], t_min[kW], t_max[kW];  ///< t_max: not beyond the best hit so far
  float limit[kW];          ///< cells entered beyond need no visit
  std::uint32_t known[kW], end[kW];  ///< triangles that need not be decided: the best so far; where the ray ends
  // For the test in double, see shear_ray.
  double shear_x[kW], shear_y[kW], inv_dz[kW];
  std::uint32_t main_axis[kW];
  float tolerance[kW];  ///< of the fast test
};

/// Fetches the cache lines of so many floats ahead. Inline in any case, as must be all that does
/// nothing else: gcc 12 takes a function that only fetches for one without effect, and leaves its
/// calls out.
template <std::size_t kFloats>
[[gnu::always_inline]] inline void fetch_ahead(const float* first) {
  for (std::size_t line = 0; line < kFloats; line += 16) __builtin_prefetch(first + line);
}

/// The first block of a leaf, and the second one where V fetches more.
template <class V, std::size_t kBlockFloats>
[[gnu::always_inline]] inline void fetch_leaf(const float* first, std::uint32_t count) {
  fetch_ahead<kBlockFloats>(first);
  if (V::kFetchesMore && count > 1) fetch_ahead<kBlockFloats>(first + kBlockFloats);
}

/// 0 follows 2. Without a branch: rays in neighbouring lanes have main axes as they come.
inline std::size_t axis_after(std::size_t axis) { return 9U >> 2 * axis & 3U; }

/// Lanes that hold the same triangle: the first one of a row.
template <class V>
struct Repeated : V {
  static typename V::F load(const float* p) { return V::set1(*p); }
};

}  // namespace
}  // namespace raykiln::render
