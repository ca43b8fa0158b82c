// The triangle test of test_lane in double for several lanes at once: one ray against neighbouring
// triangles of a block, or neighbouring rays of a packet against one triangle. The same operations in
// the same order, each rounded once, so the same bits; where the sign of an edge function is in doubt,
// which takes a fused multiply-add, test_lane itself is asked. Internal linkage only.
#pragma once

#include <cstddef>
#include <cstdint>

#include "walk_limits.hpp"

namespace raykiln::render {
namespace {

/// What the test needs of rays, in every lane; x, y, z are the sheared axes.
template <class D>
struct ExactRay {
  typename D::F ox, oy, oz, sx, sy, inv_dz, t_min, t_max;
};

/// Of each lane: whether it is a hit within the ray's interval, or whether test_lane must say so.
template <class D>
struct ExactHits {
  std::uint32_t hit, doubt;
  alignas(64) float t[D::kWidth], u[D::kWidth], v[D::kWidth];
};

/// corner(c, axis) gives coordinates of corner c of the lanes' triangles, in double; axis: 0, 1, 2 for
/// the sheared x, y, z.
template <class D, class Corner>
inline void test_exactly(const ExactRay<D>& ray, Corner&& corner, ExactHits<D>& out) {
  using F = typename D::F;
  F x[3], y[3], z[3];
  for (std::size_t c = 0; c < 3; ++c) {
    z[c] = D::sub(corner(c, 2), ray.oz);
    x[c] = D::sub(D::sub(corner(c, 0), ray.ox), D::mul(ray.sx, z[c]));
    y[c] = D::sub(D::sub(corner(c, 1), ray.oy), D::mul(ray.sy, z[c]));
  }
  std::uint32_t doubt = 0;
  const auto cross = [&](std::size_t a, std::size_t b) {
    const F ab = D::mul(x[a], y[b]);
    const F cd = D::mul(y[a], x[b]);
    doubt |= D::eq(ab, cd);
    return D::sub(ab, cd);
  };
  const F u = cross(2, 1);
  const F v = cross(0, 2);
  const F w = cross(1, 0);
  const F zero = D::set1(0.0);
  // With a NaN among them the determinant is NaN, and nothing is hit.
  const std::uint32_t mixed =
      D::lt(D::min(D::min(u, v), w), zero) & D::lt(zero, D::max(D::max(u, v), w));
  const F det = D::add(D::add(u, v), w);
  const F weighted = D::add(D::add(D::mul(u, z[0]), D::mul(v, z[1])), D::mul(w, z[2]));
  const F t = D::round_to_float(D::div(D::mul(weighted, ray.inv_dz), det));
  const std::uint32_t within = D::le(ray.t_min, t) & D::le(t, ray.t_max) &
                               D::le(D::abs(t), D::set1(static_cast<double>(kLargestFloat)));
  out.hit = ~mixed & within & (D::lt(det, zero) | D::lt(zero, det)) & ~doubt;
  out.doubt = doubt;
  if (out.hit == 0) return;
  D::store(out.t, t);
  D::store(out.u, D::div(v, det));
  D::store(out.v, D::div(w, det));
}

}  // namespace
}  // namespace raykiln::render
