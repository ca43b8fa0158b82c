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

/// Lanes that hold the same triangle: the first one of a row.
template <class V>
struct Repeated : V {
  static typename V::F load(const float* p) { return V::set1(*p); }
};

}  // namespace
}  // namespace raykiln::render
