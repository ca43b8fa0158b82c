// Directions towards bodies that may focus light, of kLanes vertices at once: raykiln/shading/caster_cones.hpp is the
// reference; same operations, same order, same bits.
#pragma once

#include "lane_surface.hpp"
#include "matte_query.hpp"

namespace raykiln::render {
namespace {

struct LaneCone {
  V3f axis;
  F64 width, share, density;
};

/// CasterCones of each lane; of those that are not `open` all shares are 0. Cones that are not drawn from have share, width and density 0.
struct LaneCones {
  LaneCone cones[kLaneMostCasters];
  std::size_t count;
  F64 rest;
};

inline void see_casters(LaneCones& seen, const LaneCasters& casters, const V3& p, const V3& normal,
                        I64 open) {
  seen.count = casters.count;
  seen.rest = all(1.0);
  F64 sum{};
  for (std::size_t i = 0; i < casters.count; ++i) {
    LaneCone& cone = seen.cones[i];
    const double* sphere = casters.spheres + 4 * i;
    const V3 way = V3{all(sphere[0]), all(sphere[1]), all(sphere[2])} - p;
    const F64 distance2 = dot(way, way);
    const F64 sine2 = sphere[3] * sphere[3] / distance2;
    cone.axis = narrow(way / root(distance2));
    const F64 height = dot(normal, wide(cone.axis));
    const I64 drawn = open & (sine2 >= casters.least_cone) & (sine2 < 1.0) & (height > 0.0);
    const F64 fraction = sine2 * height;
    cone.width = select(drawn, sine2 / (1.0 + root(1.0 - sine2)), F64{});
    cone.share = select(drawn, casters.boost * fraction * ((1.0 - fraction) * (1.0 - fraction)), F64{});
    sum += cone.share;
  }
  const F64 scale = select(sum > casters.most, casters.most / sum, all(1.0));
  for (std::size_t i = 0; i < seen.count; ++i) {
    LaneCone& cone = seen.cones[i];
    const I64 drawn = cone.share > 0.0;
    cone.share *= scale;
    cone.density = select(drawn, cone.share / (2.0 * kLanePi * cone.width), F64{});
    seen.rest -= cone.share;
  }
}

inline F64 mixed_pdf(const LaneCones& seen, const V3& wi, F64 pdf) {
  F64 mixed = seen.rest * pdf;
  for (std::size_t i = 0; i < seen.count; ++i) {
    const LaneCone& cone = seen.cones[i];
    const V3 apart = wi - wide(cone.axis);
    mixed += select(0.5 * dot(apart, apart) <= cone.width, cone.density, F64{});
  }
  return mixed;
}

/// Axis and 1 - cos of the directions that are drawn with the numbers `choice` and `u`; where no cone is drawn, as given.
inline void choose_cone(const LaneCones& seen, F64 choice, F64 u, V3f& axis, F64& x) {
  I64 open = ~I64{};
  for (std::size_t i = 0; i < seen.count; ++i) {
    const LaneCone& cone = seen.cones[i];
    const I64 drawn = open & (choice < cone.share);
    const I32 narrow_drawn = __builtin_convertvector(drawn, I32);
    axis = {narrow_drawn ? cone.axis.x : axis.x, narrow_drawn ? cone.axis.y : axis.y, narrow_drawn ? cone.axis.z : axis.z};
    x = select(drawn, cone.width * u, x);
    open &= ~drawn;
    choice -= cone.share;
  }
}

}  // namespace
}  // namespace raykiln::render
