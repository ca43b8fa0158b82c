// One ray against the triangles of one leaf block, in float, sorting out what is missed for certain:
// the filter of triangle_test.hpp, which also derives its error bound. Internal linkage only.
#pragma once

#include <cstddef>
#include <cstdint>

#include "lane_query.hpp"
#include "walk_limits.hpp"

namespace raykiln::render {
namespace {

/// What the filter needs of one ray, in every lane. x, y, z are the sheared axes.
template <class V>
struct FilterRay {
  typename V::F ox, oy, oz, sx, sy;
  std::size_t x, y, z;  ///< place of the axis within a corner of a block, in floats
};

template <class V>
inline typename V::F largest_of(typename V::F a, typename V::F b, typename V::F c) {
  return V::larger_magnitude(V::larger_magnitude(a, b), c);
}

template <class V>
inline typename V::F edge_function(typename V::F ax, typename V::F ay, typename V::F bx,
                                   typename V::F by) {
  return V::sub(V::mul(ax, by), V::mul(ay, bx));
}

/// A bit for each of V::kWidth triangles of a block of kLeafWidth that may be hit; `block` points to
/// the first of them.
template <class V, int kLeafWidth>
inline std::uint32_t may_be_hit(const FilterRay<V>& ray, const float* block) {
  using F = typename V::F;
  constexpr std::size_t kCorner = 3 * kLeafWidth;
  F x[3], y[3], z[3];
  for (std::size_t c = 0; c < 3; ++c) {
    const float* corner = block + c * kCorner;
    z[c] = V::sub(V::load(corner + ray.z), ray.oz);
    x[c] = V::sub(V::sub(V::load(corner + ray.x), ray.ox), V::mul(ray.sx, z[c]));
    y[c] = V::sub(V::sub(V::load(corner + ray.y), ray.oy), V::mul(ray.sy, z[c]));
  }
  const F u = edge_function<V>(x[2], y[2], x[1], y[1]);
  const F v = edge_function<V>(x[0], y[0], x[2], y[2]);
  const F w = edge_function<V>(x[1], y[1], x[0], y[0]);
  const F h = V::max(largest_of<V>(x[0], x[1], x[2]), largest_of<V>(y[0], y[1], y[2]));
  const F m = V::add(h, largest_of<V>(z[0], z[1], z[2]));
  // m (h + ...) first: where a product of corners overflows, so does this, and the lane passes.
  const F mh = V::mul(m, V::add(h, V::mul(V::set1(kFilterCorner), m)));
  const F e = V::add(V::mul(mh, V::set1(kFilterEdge)), V::set1(kFilterUnderflow));
  const F least = V::min(V::min(u, v), w);
  const F most = V::max(V::max(u, v), w);
  const auto missed = V::both(V::lt(least, V::turn_sign(e, V::set1(-1.0F))), V::lt(e, most));
  return ~V::bits(missed) & ((1U << V::kWidth) - 1U);
}

/// A bit for each of V::kWidth ids that is neither padding nor `known`.
template <class V>
inline std::uint32_t worth_deciding(const std::uint32_t* ids, std::uint32_t known) {
  const auto i = V::load(ids);
  const auto no = V::either(V::eq(i, V::set1(kLaneNoHit)), V::eq(i, V::set1(known)));
  return ~V::bits(no) & ((1U << V::kWidth) - 1U);
}

}  // namespace
}  // namespace raykiln::render
