// What the kernels do at a leaf: sort out the triangles that may be hit and ask for the last word on
// them. Either one ray against the triangles of a block at once, or one triangle against the rays of
// a packet at once. Internal linkage only.
#pragma once

#include <cstddef>
#include <cstdint>

#include "lane_exact.hpp"
#include "lane_filter.hpp"
#include "lane_query.hpp"
#include "lane_rays.hpp"

namespace raykiln::render {
namespace {

/// V: lanes of the walk. B: lanes of a leaf block, dividing kLeafWidth. Twice: lanes of two
/// neighbouring blocks, or B again. D: lanes of the test in double of a packet's rays, One: of one
/// ray, both dividing the others.
template <class V, class B, class Twice, class D, class One, int kLeafWidth, bool kAnyHit>
class LeafVisit {
 public:
  using Rays = LeafRays<V::kWidth>;
  static constexpr std::size_t kBlockFloats = 10 * kLeafWidth;
  static constexpr bool kMoreSlack = false;
  static constexpr bool kInDouble = true;
  static constexpr bool kHasEnds = kAnyHit;  ///< LeafRays::end is looked at
  /// Leaves of up to two blocks can be filtered first, for several rays, and decided later.
  static constexpr bool kDecidesLater = !kAnyHit && Twice::kWidth == 2 * B::kWidth;
  static constexpr std::uint32_t kMostFiltered = 2;  ///< blocks of a leaf

  /// What the filter leaves of a block for the ray in `lane`.
  struct Asked {
    std::uint32_t lane, place, found;
  };

  LeafVisit(const LaneQuery& query, LaneCounts& counts)
      : query_(query), counts_(counts), go_on_(kAnyHit && query.node_count <= kFewNodes ? 0 : ~0U) {}

  /// The ray `index`, which is in `lane`, at a leaf of `count` blocks from `place` on. True when it
  /// is done.
  [[gnu::always_inline]] bool one_ray(Rays& rays, std::uint32_t lane, std::size_t index,
                                      std::uint32_t place, std::uint32_t count) const {
    if (count >= kMany) return many_blocks(rays, lane, index, place, count);
    return blocks_of_lane(rays, lane, index, place, count);
  }

  /// Filters a leaf of kMostFiltered blocks or fewer for the ray in `lane`; says in how many blocks there is
  /// something to decide, and in `asked` what. Without a branch on what is found.
  [[gnu::noinline]] std::uint32_t filter(const Rays& rays, std::uint32_t lane, std::uint32_t place,
                                         std::uint32_t count, Asked* asked) const {
    counts_.block_tests += count;
    const float* const block = query_.blocks + kBlockFloats * place;
    if (count == 1) {
      const std::uint32_t found = candidates<B, false>(filter_ray<B>(rays, lane), block, rays, lane).maybe;
      asked[0] = {lane, place, found};
      return found != 0 ? 1 : 0;
    }
    const std::uint32_t found = candidates<Twice, false>(filter_ray<Twice>(rays, lane), block, rays, lane).maybe;
    asked[0] = {lane, place, found & 0xFFU};
    const std::uint32_t n = (found & 0xFFU) != 0 ? 1 : 0;
    asked[n] = {lane, place + 1, found >> 8};
    return n + (found >> 8 != 0 ? 1 : 0);
  }

  void decide(Rays& rays, const Asked& asked, std::size_t index) const {
    decide_found(rays, asked.lane, index, asked.place, asked.found);
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
      if (count < kMany) {
        for (std::uint32_t rest = lanes; rest != 0; rest &= rest - 1) {
          const auto lane = static_cast<std::uint32_t>(__builtin_ctz(rest));
          if (few_blocks<true>(rays, lane, rays.index[lane], place, count)) done |= 1U << lane;
        }
        return done;
      }
      for (std::uint32_t rest = lanes; rest != 0; rest &= rest - 1) {
        const auto lane = static_cast<std::uint32_t>(__builtin_ctz(rest));
        if (many_blocks(rays, lane, rays.index[lane], place, count)) done |= 1U << lane;
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
  static constexpr std::uint32_t kInDoubles = (1U << D::kWidth) - 1U;
  static constexpr std::uint32_t kOneInDoubles = (1U << One::kWidth) - 1U;
  static constexpr std::uint32_t kMany = 8;  ///< blocks of a leaf
  /// Whether rays in lanes leave the filter after the edge functions, as those of packets do. With AVX-512 only
  /// any-hit rays in trees of up to kFewNodes: elsewhere the branch is guessed wrongly too often.
  static constexpr bool kExits = !V::kGoesOn;
  static constexpr std::uint64_t kFewNodes = 1U << 17;
  /// About so many lanes of a block hold a triangle.
  static constexpr std::uint32_t kTrianglesABlock = 3 * kLeafWidth / 4;

  // Out of line: within the walk's loop its registers cost the steps.
  [[gnu::noinline]] bool blocks_of_lane(Rays& rays, std::uint32_t lane, std::size_t index,
                                        std::uint32_t place, std::uint32_t count) const {
    return few_blocks<kExits>(rays, lane, index, place, count);
  }

  // Most leaves have one block or two: these are done without a loop, whose constants a call would
  // have to save.
  template <bool kExit>
  bool few_blocks(Rays& rays, std::uint32_t lane, std::size_t index, std::uint32_t place,
                  std::uint32_t count) const {
    if (count == 1) return one_block<kExit>(filter_ray<B>(rays, lane), rays, lane, index, place);
    if constexpr (kTwice) {
      if (count == 2) return two_blocks<kExit>(filter_ray<Twice>(rays, lane), rays, lane, index, place);
    }
    return some_blocks<kExit>(rays, lane, index, place, count);
  }

  template <bool kExit>
  [[gnu::noinline]] bool some_blocks(Rays& rays, std::uint32_t lane, std::size_t index, std::uint32_t place,
                                     std::uint32_t count) const {
    if constexpr (kTwice) {
      const auto ray = filter_ray<Twice>(rays, lane);
      for (; count > 1; count -= 2, place += 2) {
        if (two_blocks<kExit>(ray, rays, lane, index, place)) return true;
      }
    }
    if (count == 0) return false;
    const auto ray = filter_ray<B>(rays, lane);
    for (; count != 0; --count, ++place) {
      if (one_block<kExit>(ray, rays, lane, index, place)) return true;
    }
    return false;
  }

  template <bool kExit>
  [[gnu::always_inline]] bool two_blocks(const FilterRay<Twice>& ray, Rays& rays, std::uint32_t lane,
                                         std::size_t index, std::uint32_t place) const {
    const auto both = candidates<Twice, kExit>(ray, query_.blocks + kBlockFloats * place, rays, lane);
    ++counts_.block_tests;
    if (decide(rays, lane, index, place, {both.maybe & 0xFFU, both.sure & 0xFFU})) return true;
    ++counts_.block_tests;
    return decide(rays, lane, index, place + 1, {both.maybe >> 8, both.sure >> 8});
  }

  template <bool kExit>
  [[gnu::always_inline]] bool one_block(const FilterRay<B>& ray, Rays& rays, std::uint32_t lane,
                                        std::size_t index, std::uint32_t place) const {
    const float* const block = query_.blocks + kBlockFloats * place;
    ++counts_.block_tests;
    Found found{0, 0};
    for (std::uint32_t at = 0; at < kLeafWidth; at += B::kWidth) {
      const Found part = candidates<B, kExit>(ray, block + at, rays, lane);
      found.maybe |= part.maybe << at;
      found.sure |= part.sure << at;
    }
    return decide(rays, lane, index, place, found);
  }

  // A leaf of many blocks holds long triangles that are mostly missed by far: one error bound serves
  // for all of them.
  [[gnu::noinline]] bool many_blocks(Rays& rays, std::uint32_t lane, std::size_t index,
                                     std::uint32_t place, std::uint32_t count) const {
    constexpr std::uint32_t kStep = kTwice ? 2 : 1;
    using L = Twice;
    const auto ray = filter_ray<L>(rays, lane);
    const auto e = L::set1(largest_error(reach_of_box(rays, lane)));
    for (std::uint32_t b = 0; b < count; b += kStep) {
      const std::uint32_t n = count - b < kStep ? count - b : kStep;
      const float* const block = query_.blocks + kBlockFloats * (place + b);
      std::uint32_t allowed = n < kStep ? 1 : 0;
      for (std::uint32_t at = 0; allowed == 0 && at < kStep * kLeafWidth; at += L::kWidth) {
        FilterValues<L> f;
        form_edges<L, kLeafWidth>(ray, block + at, f);
        allowed = edges_allow<L>(f, e);
      }
      if (allowed == 0) {
        counts_.block_tests += n;
      } else if (blocks_of_lane(rays, lane, index, place + b, n)) {
        return true;
      }
    }
    return false;
  }

  // How far a coordinate of the root's box is from that of the ray's origin, at most.
  float reach_of_box(const Rays& rays, std::uint32_t lane) const {
    float reach = 0.0F;
    for (std::size_t k = 0; k < 3; ++k) {
      const float lo = __builtin_fabsf(query_.box_lo[k] - rays.o[k][lane]);
      const float hi = __builtin_fabsf(query_.box_hi[k] - rays.o[k][lane]);
      const float more = lo > hi ? lo : hi;
      reach = more > reach ? more : reach;
    }
    return reach;
  }

  template <class Ready>
  std::uint32_t packet_block(Ready& rays, std::uint32_t lanes, std::size_t axis,
                             std::uint32_t place) const {
    using R = Repeated<V>;
    const float* const block = query_.blocks + kBlockFloats * place;
    const auto* const ids = reinterpret_cast<const std::uint32_t*>(block + kIds);
    FilterRay<R> ray = filter_rays<R>(rays, axis);
    std::uint32_t done = 0;
    for (std::uint32_t i = 0; i < kLeafWidth && ids[i] != kLaneNoHit; ++i) {
      const auto id = V::set1(ids[i]);
      std::uint32_t asked = lanes & ~done & ~V::bits(V::eq(V::load(rays.known), id));
      if constexpr (kHasEnds) asked &= ~V::bits(V::eq(V::load(rays.end), id));
      const Found filtered = may_be_hit<R, kLeafWidth, kAnyHit>(ray, block + i, asked, 0);
      std::uint32_t found = filtered.maybe;
      if (found == 0) continue;
      if constexpr (kAnyHit) {
        const std::uint32_t sure = found & filtered.sure;
        for (std::uint32_t rest = sure; rest != 0; rest &= rest - 1) {
          const auto lane = static_cast<std::uint32_t>(__builtin_ctz(rest));
          if (stopped(rays.index[lane], ids[i])) done |= 1U << lane;
        }
        found &= ~sure;
      }
      if (found == 0) continue;
      done |= decide_rays(rays, found, axis, place, i);
      ray.t_max = V::load(rays.t_max);
    }
    return done;
  }

  // The last word on triangle i of a block for the rays of `found`. A bit for each that is done.
  template <class Ready>
  [[gnu::noinline]] std::uint32_t decide_rays(Ready& rays, std::uint32_t found, std::size_t z, std::uint32_t place,
                            std::uint32_t i) const {
    const std::size_t axes[3] = {axis_after(z), axis_after(axis_after(z)), z};
    const float* const triangle = query_.blocks + kBlockFloats * place + i;
    const std::uint32_t id = id_of(triangle);
    std::uint32_t done = 0;
    ExactHits<D> exact;
    for (std::uint32_t from = 0; from < V::kWidth; from += D::kWidth) {
      const std::uint32_t asked = found >> from & kInDoubles;
      if (asked == 0) continue;
      counts_.exact_tests += static_cast<std::uint32_t>(__builtin_popcount(asked));
      const ExactRay<D> ray = {D::load(rays.o[axes[0]] + from), D::load(rays.o[axes[1]] + from),
                               D::load(rays.o[z] + from),       D::load(rays.shear_x + from),
                               D::load(rays.shear_y + from),    D::load(rays.inv_dz + from),
                               D::load(rays.t_min + from),      D::load(rays.t_max + from)};
      test_exactly<D>(ray, [&](std::size_t c, std::size_t k) {
        return D::set1(static_cast<double>(triangle[(3 * c + axes[k]) * kLeafWidth]));
      }, exact);
      for (std::uint32_t rest = asked & (exact.hit | exact.doubt); rest != 0; rest &= rest - 1) {
        const auto k = static_cast<std::uint32_t>(__builtin_ctz(rest));
        const std::uint32_t lane = from + k;
        const bool ends = (exact.doubt >> k & 1U) != 0
                              ? ask(rays, lane, rays.index[lane], place, 1U << i)
                              : keep(rays, lane, rays.index[lane], exact, k, id);
        if (ends) done |= 1U << lane;
      }
    }
    return done;
  }

  // The last word on the candidates of a block for one ray. True when it is done.
  bool decide(Rays& rays, std::uint32_t lane, std::size_t index, std::uint32_t place, Found found) const {
    if constexpr (kAnyHit) {
      const float* const block = query_.blocks + kBlockFloats * place;
      for (std::uint32_t rest = found.maybe & found.sure; rest != 0; rest &= rest - 1) {
        if (stopped(index, id_of(block + __builtin_ctz(rest)))) return true;
      }
      found.maybe &= ~found.sure;
    }
    return found.maybe != 0 && decide_found(rays, lane, index, place, found.maybe);
  }

  // Whether triangle `id`, which is hit for certain, ends an any-hit ray: where it is does not matter.
  bool stopped(std::size_t index, std::uint32_t id) const {
    return query_.keep(query_.context, index, 0.0F, id, 0.0F, 0.0F).id != kLaneNoHit;
  }

  [[gnu::noinline]] bool decide_found(Rays& rays, std::uint32_t lane, std::size_t index, std::uint32_t place,
              std::uint32_t found) const {
    counts_.exact_tests += static_cast<std::uint32_t>(__builtin_popcount(found));
    const std::size_t z = rays.main_axis[lane];
    const std::size_t axes[3] = {axis_after(z), axis_after(axis_after(z)), z};
    const auto all = [](float value) { return One::set1(static_cast<double>(value)); };
    ExactRay<One> ray = {all(rays.o[axes[0]][lane]),     all(rays.o[axes[1]][lane]),
                       all(rays.o[z][lane]),           One::set1(rays.shear_x[lane]),
                       One::set1(rays.shear_y[lane]),    One::set1(rays.inv_dz[lane]),
                       all(rays.t_min[lane]),          all(rays.t_max[lane])};
    const float* const block = query_.blocks + kBlockFloats * place;
    ExactHits<One> exact;
    for (std::uint32_t from = 0; from < kLeafWidth; from += One::kWidth) {
      const std::uint32_t asked = found >> from & kOneInDoubles;
      if (asked == 0) continue;
      test_exactly<One>(ray, [&](std::size_t c, std::size_t k) {
        return One::load(block + (3 * c + axes[k]) * kLeafWidth + from);
      }, exact);
      const std::uint32_t doubt = asked & exact.doubt;
      if (doubt != 0 && ask(rays, lane, index, place, doubt << from)) return true;
      for (std::uint32_t rest = asked & exact.hit; rest != 0; rest &= rest - 1) {
        const auto k = static_cast<std::uint32_t>(__builtin_ctz(rest));
        if (keep(rays, lane, index, exact, k, id_of(block + from + k))) return true;
      }
    }
    return false;
  }

  static std::uint32_t id_of(const float* triangle) {
    return *reinterpret_cast<const std::uint32_t*>(triangle + kIds);
  }

  bool ask(Rays& rays, std::uint32_t lane, std::size_t index, std::uint32_t block,
           std::uint32_t found) const {
    const LaneShear shear = {rays.shear_x[lane], rays.shear_y[lane], rays.inv_dz[lane],
                             rays.main_axis[lane]};
    return update(rays, lane, query_.decide(query_.context, index, shear, block, found));
  }

  template <class Exact>
  bool keep(Rays& rays, std::uint32_t lane, std::size_t index, const Exact& exact, std::uint32_t k,
            std::uint32_t id) const {
    return update(rays, lane,
                  query_.keep(query_.context, index, exact.t[k], id, exact.u[k], exact.v[k]));
  }

  // True when the ray is done.
  static bool update(Rays& rays, std::uint32_t lane, const LaneBest& best) {
    if (kAnyHit) return best.id != kLaneNoHit;
    rays.limit[lane] = best.t;
    if (best.t < rays.t_max[lane]) rays.t_max[lane] = best.t;
    rays.known[lane] = best.id;
    return false;
  }

  template <class L>
  [[gnu::always_inline]] static FilterRay<L> filter_ray(const Rays& rays, std::uint32_t lane) {
    const std::size_t z = rays.main_axis[lane];
    const std::size_t x = axis_after(z);
    const std::size_t y = axis_after(x);
    return {L::set1(rays.o[x][lane]),  L::set1(rays.o[y][lane]), L::set1(rays.o[z][lane]),
            L::set1(rays.sx[lane]),    L::set1(rays.sy[lane]),   L::set1(rays.inv_d[z][lane]),
            L::set1(rays.t_min[lane]), L::set1(rays.t_max[lane]),
            x * kLeafWidth,            y * kLeafWidth,           z * kLeafWidth};
  }

  template <class R>
  static FilterRay<R> filter_rays(const Rays& rays, std::size_t z) {
    const std::size_t x = axis_after(z);
    const std::size_t y = axis_after(x);
    return {V::load(rays.o[x]),  V::load(rays.o[y]), V::load(rays.o[z]),
            V::load(rays.sx),    V::load(rays.sy),   V::load(rays.inv_d[z]),
            V::load(rays.t_min), V::load(rays.t_max),
            x * kLeafWidth,      y * kLeafWidth,     z * kLeafWidth};
  }

  // Those of a block, or of the part of it that begins at `block`, that have to be decided.
  template <class L, bool kExit>
  [[gnu::always_inline]] Found candidates(const FilterRay<L>& ray, const float* block, const Rays& rays, std::uint32_t lane) const {
    const auto* const ids = reinterpret_cast<const std::uint32_t*>(block + kIds);
    std::uint32_t asked = worth_deciding<L>(ids, rays.known[lane]);
    if constexpr (kHasEnds) asked &= ~L::bits(L::eq(L::load(ids), L::set1(rays.end[lane])));
    return may_be_hit<L, kLeafWidth, kAnyHit>(ray, block, asked, kExit ? 0 : go_on_);
  }

  const LaneQuery& query_;
  LaneCounts& counts_;
  const std::uint32_t go_on_;
};

}  // namespace
}  // namespace raykiln::render
