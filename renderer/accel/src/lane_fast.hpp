// What the kernels do at a leaf with the fast triangle test: the operations of FastTest::lane in its
// order, so the same bits. Either one ray against the triangles of a block at once, or one triangle
// against the rays of a packet. Internal linkage only.
#pragma once

#include <cstddef>
#include <cstdint>

#include "lane_query.hpp"
#include "lane_rays.hpp"
#include "walk_limits.hpp"

namespace raykiln::render {
namespace {

/// What the test needs of rays, in every lane. x, y, z are the sheared axes.
template <class V>
struct FastRays {
  typename V::F ox, oy, oz, sx, sy, inv_dz, t_min, t_max, tolerance;
  std::size_t x, y, z;  ///< place of the axis within a corner of a block, in floats
};

/// Of each lane: whether it is a hit within the ray's interval, or whether FastTest::lane must say so.
template <class V>
struct FastHits {
  std::uint32_t hit, doubt;
  alignas(64) float t[V::kWidth], u[V::kWidth], v[V::kWidth];
};

/// V::kWidth triangles of a block of kLeafWidth; `block` points to the first of them.
template <class V, int kLeafWidth>
inline void test_fast(const FastRays<V>& ray, const float* block, FastHits<V>& out) {
  using F = typename V::F;
  constexpr std::size_t kCorner = 3 * kLeafWidth;
  F x[3], y[3], z[3];
  for (std::size_t c = 0; c < 3; ++c) {
    const float* corner = block + c * kCorner;
    z[c] = V::sub(V::load(corner + ray.z), ray.oz);
    x[c] = V::sub(V::sub(V::load(corner + ray.x), ray.ox), V::mul(ray.sx, z[c]));
    y[c] = V::sub(V::sub(V::load(corner + ray.y), ray.oy), V::mul(ray.sy, z[c]));
  }
  const auto edge = [&](std::size_t a, std::size_t b) {
    return V::sub(V::mul(x[a], y[b]), V::mul(y[a], x[b]));
  };
  const F u = edge(2, 1);
  const F v = edge(0, 2);
  const F w = edge(1, 0);
  const F det = V::add(V::add(u, v), w);
  const F zero = V::set1(0.0F);
  // With a NaN among them the determinant is NaN, and nothing is hit.
  const auto mixed = V::both(V::lt(V::min(V::min(u, v), w), zero),
                             V::lt(zero, V::max(V::max(u, v), w)));
  const auto area = V::either(V::lt(det, zero), V::lt(zero, det));
  const std::uint32_t met = V::bits(V::not_but(mixed, area));
  out.hit = out.doubt = 0;
  if (met == 0) return;
  const F inv = V::div(V::set1(1.0F), det);
  const F a = V::mul(u, inv);
  const F b = V::mul(v, inv);
  const F c = V::mul(w, inv);
  const auto mean = [&](const F* of) {
    return V::add(V::add(V::mul(a, of[0]), V::mul(b, of[1])), V::mul(c, of[2]));
  };
  const auto sure = V::both(V::le(V::abs(det), V::set1(kFastLargestDeterminant)),
                            V::both(V::le(V::abs(mean(x)), ray.tolerance),
                                    V::le(V::abs(mean(y)), ray.tolerance)));
  const F t = V::mul(mean(z), ray.inv_dz);
  const auto within = V::both(V::both(V::le(ray.t_min, t), V::le(t, ray.t_max)),
                              V::le(V::abs(t), V::set1(kLargestFloat)));
  out.hit = met & V::bits(V::both(sure, within));
  out.doubt = met & ~V::bits(sure);
  if (out.hit == 0) return;
  V::store(out.t, t);
  V::store(out.u, b);
  V::store(out.v, c);
}

/// V: lanes of the walk. B: lanes of a leaf block, dividing kLeafWidth. Twice: lanes of two
/// neighbouring blocks, or B again.
template <class V, class B, class Twice, int kLeafWidth, bool kAnyHit>
class FastLeafVisit {
 public:
  static constexpr std::size_t kBlockFloats = 10 * kLeafWidth;
  static constexpr bool kMoreSlack = true;
  static constexpr bool kInDouble = false;
  static constexpr bool kHasEnds = false;
  static constexpr bool kDecidesLater = false;

  FastLeafVisit(const LaneQuery& query, LaneCounts& counts) : query_(query), counts_(counts) {}

  /// The ray `index`, which is in `lane`, at a leaf of `count` blocks from `place` on. True when it
  /// is done.
  template <class Rays>
  [[gnu::always_inline]] bool one_ray(Rays& rays, std::uint32_t lane, std::size_t index, std::uint32_t place,
               std::uint32_t count) const {
    const float* const first = query_.blocks + kBlockFloats * place;
    std::uint32_t b = 0;
    if constexpr (kTwice) {
      if (count > 1) {
        const auto ray = fast_ray<Twice>(rays, lane);
        FastHits<Twice> both;
        for (; b + 1 < count; b += 2) {
          test_fast<Twice, kLeafWidth>(ray, first + kBlockFloats * b, both);
          ++counts_.block_tests;
          if (take(rays, lane, index, place + b, both, 0, 0)) return true;
          ++counts_.block_tests;
          if (take(rays, lane, index, place + b + 1, both, B::kWidth, 0)) return true;
        }
      }
      if (b == count) return false;
    }
    const auto ray = fast_ray<B>(rays, lane);
    FastHits<B> hits;
    for (; b < count; ++b) {
      ++counts_.block_tests;
      for (std::uint32_t at = 0; at < kLeafWidth; at += B::kWidth) {
        test_fast<B, kLeafWidth>(ray, first + kBlockFloats * b + at, hits);
        if (take(rays, lane, index, place + b, hits, 0, at)) return true;
      }
    }
    return false;
  }

  /// The rays of `lanes`, all with the same main axis. A bit for each that is done.
  template <class Ready>
  std::uint32_t packet(Ready& rays, std::uint32_t lanes, std::uint32_t place,
                       std::uint32_t count) const {
    const auto n = static_cast<std::uint32_t>(__builtin_popcount(lanes));
    const std::uint32_t tests =
        kTwice ? (count + 1) / 2 : count * static_cast<std::uint32_t>(kLeafWidth / B::kWidth);
    std::uint32_t done = 0;
    if (n * tests < kTrianglesABlock * count) {
      for (std::uint32_t rest = lanes; rest != 0; rest &= rest - 1) {
        const auto lane = static_cast<std::uint32_t>(__builtin_ctz(rest));
        if (one_ray(rays, lane, rays.index[lane], place, count)) done |= 1U << lane;
      }
      return done;
    }
    const std::size_t axis = rays.main_axis[__builtin_ctz(lanes)];
    for (std::uint32_t b = 0; b < count && lanes != done; ++b) {
      counts_.block_tests += static_cast<std::uint32_t>(__builtin_popcount(lanes & ~done));
      done |= packet_block(rays, lanes & ~done, axis, place + b);
    }
    return done;
  }

 private:
  static constexpr bool kTwice = Twice::kWidth == 2 * B::kWidth;
  static constexpr std::size_t kIds = 9 * kLeafWidth;
  /// About so many lanes of a block hold a triangle.
  static constexpr std::uint32_t kTrianglesABlock = 3 * kLeafWidth / 4;

  template <class Ready>
  [[gnu::always_inline]] std::uint32_t packet_block(Ready& rays, std::uint32_t lanes, std::size_t axis,
                             std::uint32_t place) const {
    using R = Repeated<V>;
    const float* const block = query_.blocks + kBlockFloats * place;
    const std::uint32_t* const ids = ids_of(block);
    FastRays<R> ray = fast_rays<R>(rays, axis);
    FastHits<R> hits;
    std::uint32_t done = 0;
    for (std::uint32_t i = 0; i < kLeafWidth && ids[i] != kLaneNoHit; ++i) {
      test_fast<R, kLeafWidth>(ray, block + i, hits);
      std::uint32_t found = (hits.hit | hits.doubt) & lanes & ~done;
      if (found == 0) continue;
      found &= ~V::bits(V::eq(V::load(rays.known), V::set1(ids[i])));
      for (std::uint32_t rest = found; rest != 0; rest &= rest - 1) {
        const auto lane = static_cast<std::uint32_t>(__builtin_ctz(rest));
        if (keep(rays, lane, rays.index[lane], place, i, hits, lane)) done |= 1U << lane;
      }
      ray.t_max = V::load(rays.t_max);
    }
    return done;
  }

  // What was found in the B::kWidth triangles of a block from `at` on; they are in the lanes of `hits`
  // from `from` on. True when the ray is done.
  template <class Rays, class L>
  bool take(Rays& rays, std::uint32_t lane, std::size_t index, std::uint32_t place,
            const FastHits<L>& hits, std::uint32_t from, std::uint32_t at) const {
    constexpr std::uint32_t kBlockLanes = (1U << B::kWidth) - 1U;
    const std::uint32_t found = (hits.hit | hits.doubt) >> from & kBlockLanes;
    return found != 0 && take_found(rays, lane, index, place, hits, found, from, at);
  }

  template <class Rays, class L>
  [[gnu::noinline]] bool take_found(Rays& rays, std::uint32_t lane, std::size_t index,
                                    std::uint32_t place, const FastHits<L>& hits,
                                    std::uint32_t found, std::uint32_t from,
                                    std::uint32_t at) const {
    const std::uint32_t* const ids = ids_of(query_.blocks + kBlockFloats * place) + at;
    for (; found != 0; found &= found - 1) {
      const auto i = static_cast<std::uint32_t>(__builtin_ctz(found));
      if (ids[i] == rays.known[lane] || ids[i] == kLaneNoHit) continue;
      if (keep(rays, lane, index, place, at + i, hits, from + i)) return true;
    }
    return false;
  }

  // Triangle i of a block for one ray, whose hit is in lane k of `hits`. True when the ray is done.
  template <class Rays, class L>
  bool keep(Rays& rays, std::uint32_t lane, std::size_t index, std::uint32_t place,
            std::uint32_t i, const FastHits<L>& hits, std::uint32_t k) const {
    LaneBest best;
    if ((hits.doubt >> k & 1U) != 0) {
      best = query_.decide(query_.context, index, LaneShear{}, place, 1U << i);
    } else {
      const std::uint32_t id = ids_of(query_.blocks + kBlockFloats * place)[i];
      best = query_.keep(query_.context, index, hits.t[k], id, hits.u[k], hits.v[k]);
    }
    if (kAnyHit) return best.id != kLaneNoHit;
    rays.limit[lane] = best.t;
    if (best.t < rays.t_max[lane]) rays.t_max[lane] = best.t;
    rays.known[lane] = best.id;
    return false;
  }

  static const std::uint32_t* ids_of(const float* block) {
    return reinterpret_cast<const std::uint32_t*>(block + kIds);
  }

  template <class L, class Rays>
  static FastRays<L> fast_ray(const Rays& rays, std::uint32_t lane) {
    const std::size_t z = rays.main_axis[lane];
    const std::size_t x = axis_after(z);
    const std::size_t y = axis_after(x);
    return {L::set1(rays.o[x][lane]),  L::set1(rays.o[y][lane]), L::set1(rays.o[z][lane]),
            L::set1(rays.sx[lane]),    L::set1(rays.sy[lane]),   L::set1(rays.inv_d[z][lane]),
            L::set1(rays.t_min[lane]), L::set1(rays.t_max[lane]),
            L::set1(rays.tolerance[lane]),
            x * kLeafWidth,            y * kLeafWidth,           z * kLeafWidth};
  }

  template <class R, class Ready>
  static FastRays<R> fast_rays(const Ready& rays, std::size_t z) {
    const std::size_t x = axis_after(z);
    const std::size_t y = axis_after(x);
    return {V::load(rays.o[x]),  V::load(rays.o[y]), V::load(rays.o[z]),
            V::load(rays.sx),    V::load(rays.sy),   V::load(rays.inv_d[z]),
            V::load(rays.t_min), V::load(rays.t_max),
            V::load(rays.tolerance),
            x * kLeafWidth,      y * kLeafWidth,     z * kLeafWidth};
  }

  const LaneQuery& query_;
  LaneCounts& counts_;
};

}  // namespace
}  // namespace raykiln::render
