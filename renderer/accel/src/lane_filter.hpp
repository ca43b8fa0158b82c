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
  typename V::F inv_dz, t_min, t_max;  ///< hits beyond t_max are of no use; it may be infinite
  std::size_t x, y, z;  ///< place of the axis within a corner of a block, in floats
};

template <class V>
inline typename V::F largest_of(typename V::F a, typename V::F b, typename V::F c) {
  return V::larger_magnitude(V::larger_magnitude(a, b), c);
}

template <class V>
inline typename V::F edge_function(typename V::F ax, typename V::F ay, typename V::F bx,
                                   typename V::F by) {
  return V::mul_sub(ax, by, V::mul(ay, bx));
}

/// Edge functions and z of the corners in float, and m (h + ...) of their error bound.
template <class V>
struct FilterValues {
  typename V::F u, v, w, mh;
  typename V::F z[3];
};

/// What the filter finds of some triangles, a bit for each: `maybe` hit; `sure` of them.
struct Found {
  std::uint32_t maybe, sure;
};

/// outside: the hit of a triangle, if it is one, lies outside of the ray's interval for certain; inside: it
/// lies within for certain.
struct IntervalBits {
  std::uint32_t outside, inside;
};

/// Compares with the ray's interval; `inside` is looked for if kSure.
///
/// With e the error of an edge function, t_i = z_i / dz and R = max |t_i|, T = u t0 + v t1 + w t2 is
/// off by 3 e R for the edge functions and by 7 u (|u| + |v| + |w|) R <= 42 u h^2 R <= 1.05 e R for its
/// roundings; D = u + v + w by less than 4 e. So the sign of D is certain beyond 4 e, and then the
/// exact t is below t_min when T - t_min D < -6 e (R + |t_min|) for positive D; the roundings of the
/// product and of t itself are within that. The bound is formed so that it overflows where T or D
/// does; what underflows (products, and t to zero) is covered by terms of their own.
template <class V, bool kSure>
inline IntervalBits compare_interval(const FilterRay<V>& ray, const FilterValues<V>& f,
                                     typename V::F e) {
  using F = typename V::F;
  const F sum = V::add(V::add(f.u, f.v), f.w);
  const F size = V::abs(sum);
  const F t[3] = {V::mul(f.z[0], ray.inv_dz), V::mul(f.z[1], ray.inv_dz),
                  V::mul(f.z[2], ray.inv_dz)};
  const F weighted = V::mul_add(f.w, t[2], V::mul_add(f.v, t[1], V::mul(f.u, t[0])));
  const F depth = V::turn_sign(weighted, sum);
  const F reach = largest_of<V>(t[0], t[1], t[2]);
  const F mh8 = V::mul(f.mh, V::set1(8.0F));
  const F vanished =
      V::mul_add(size, V::set1(kVanishingT), V::set1(kVanishingProduct));
  const auto error = [&](F bound) {
    const F g = V::add(reach, V::abs(bound));
    const F underflow = V::mul_add(g, V::set1(kVanishingProduct), vanished);
    return V::mul_add(V::mul(mh8, g), V::set1(0.75F * kFilterEdge), underflow);
  };
  const F near = error(ray.t_min);
  const F far = error(ray.t_max);
  const auto before = V::lt(depth, V::mul_sub(ray.t_min, size, near));
  const auto beyond = V::lt(V::mul_add(ray.t_max, size, far), depth);
  const auto sure = V::lt(V::mul(e, V::set1(4.0F)), size);
  IntervalBits found{V::bits(V::both(sure, V::either(before, beyond))), 0};
  if constexpr (kSure) {
    // An infinite end gives NaN, and no certainty.
    const auto after = V::lt(V::mul_add(ray.t_min, size, near), depth);
    const auto until = V::lt(depth, V::mul_sub(ray.t_max, size, far));
    found.inside = V::bits(V::both(sure, V::both(after, until)));
  }
  return found;
}

/// Sheared corners in the plane across the ray.
template <class V>
struct ShearedCorners {
  typename V::F x[3], y[3];
};

/// Edge functions, and z of the corners, of V::kWidth triangles of a block of kLeafWidth; `block`
/// points to the first of them.
template <class V, int kLeafWidth>
inline ShearedCorners<V> form_edges(const FilterRay<V>& ray, const float* block, FilterValues<V>& f) {
  constexpr std::size_t kCorner = 3 * kLeafWidth;
  ShearedCorners<V> at;
  for (std::size_t c = 0; c < 3; ++c) {
    const float* corner = block + c * kCorner;
    f.z[c] = V::sub(V::load(corner + ray.z), ray.oz);
    at.x[c] = V::sub_mul(V::sub(V::load(corner + ray.x), ray.ox), ray.sx, f.z[c]);
    at.y[c] = V::sub_mul(V::sub(V::load(corner + ray.y), ray.oy), ray.sy, f.z[c]);
  }
  f.u = edge_function<V>(at.x[2], at.y[2], at.x[1], at.y[1]);
  f.v = edge_function<V>(at.x[0], at.y[0], at.x[2], at.y[2]);
  f.w = edge_function<V>(at.x[1], at.y[1], at.x[0], at.y[0]);
  return at;
}

/// A bit for each triangle whose edge functions, off by e at most, do not rule out that it is met.
template <class V>
inline std::uint32_t edges_allow(const FilterValues<V>& f, typename V::F e) {
  const auto least = V::min(V::min(f.u, f.v), f.w);
  const auto most = V::max(V::max(f.u, f.v), f.w);
  const auto missed = V::both(V::lt(least, V::turn_sign(e, V::set1(-1.0F))), V::lt(e, most));
  return ~V::bits(missed) & ((1U << V::kWidth) - 1U);
}

/// A bit for each triangle that is met for certain, its edge functions being off by e at most.
template <class V>
inline std::uint32_t edges_agree(const FilterValues<V>& f, typename V::F e) {
  const auto least = V::min(V::min(f.u, f.v), f.w);
  const auto most = V::max(V::max(f.u, f.v), f.w);
  return V::bits(V::either(V::lt(e, least), V::lt(most, V::turn_sign(e, V::set1(-1.0F)))));
}

/// Of V::kWidth triangles of a block of kLeafWidth, of which `block` points to the first, those that may be
/// hit; if kSure, also those that are, for certain. Only lanes of `asked` are of interest: padding has
/// edge functions of zero, which rule nothing out. Where edge functions rule out all of them and `go_on` is 0,
/// intervals are not looked at: less work, but a branch.
template <class V, int kLeafWidth, bool kSure>
[[gnu::always_inline]] inline Found may_be_hit(const FilterRay<V>& ray, const float* block, std::uint32_t asked, std::uint32_t go_on) {
  using F = typename V::F;
  FilterValues<V> f;
  const auto [x, y] = form_edges<V, kLeafWidth>(ray, block, f);
  const F h = V::max(largest_of<V>(x[0], x[1], x[2]), largest_of<V>(y[0], y[1], y[2]));
  const F m = V::add(h, largest_of<V>(f.z[0], f.z[1], f.z[2]));
  // m (h + ...) first: where a product of corners overflows, so does this, and the lane passes.
  f.mh = V::mul(m, V::mul_add(V::set1(kFilterCorner), m, h));
  const F e = V::mul_add(f.mh, V::set1(kFilterEdge), V::set1(kFilterUnderflow));
  const std::uint32_t lanes = edges_allow<V>(f, e) & asked;
  if ((lanes | go_on) == 0) return {0, 0};
  const IntervalBits interval = compare_interval<V, kSure>(ray, f, e);
  return {lanes & ~interval.outside, kSure ? interval.inside & edges_agree<V>(f, e) : 0};
}

/// The e of may_be_hit at most, where no coordinate of a corner is farther than `reach` from that of
/// the ray's origin: no slope is beyond 1, so h is up to 2 reach and m up to 3 reach.
inline float largest_error(float reach) {
  const float r = 1.001F * reach;
  const float h = 2.0F * r;
  const float m = 3.0F * r;
  return 1.001F * (m * (h + kFilterCorner * m)) * kFilterEdge + kFilterUnderflow;
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
