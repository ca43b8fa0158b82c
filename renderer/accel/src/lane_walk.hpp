// The walk of scalar_walk.hpp in lanes: every lane has a ray and a node of its own, all lanes of a
// group take a step together, and a lane whose ray is done takes the next one. A leaf is done for
// one ray, against all triangles of a block at once. Several groups take turns, so that the nodes
// that one waits for arrive while others work.
//
// Each ray sees the same cells in the same order with the same roundings as in the scalar walk, so
// counts of steps, visits and blocks are equal, too.
//
// Included by one unit per instruction set: internal linkage only, no standard library.
#pragma once

#include <cstddef>
#include <cstdint>

#include "lane_filter.hpp"
#include "lane_query.hpp"
#include "lane_setup.hpp"
#include "walk_limits.hpp"

namespace raykiln::render {
namespace {

constexpr float kEndless = __builtin_inff();

struct StackEntry {
  std::uint32_t node;
  float t0, t1, unused;
};

template <class V>
struct alignas(64) LaneGroup {
  static constexpr std::size_t kW = V::kWidth;
  std::uint32_t node[kW];
  float t0[kW], t1[kW];
  std::uint32_t stack_size[kW];  ///< in bytes
  float o[3][kW], inv_d[3][kW], slack[kW];
  float limit[kW];          ///< cells entered beyond need no visit
  std::uint32_t known[kW];  ///< a triangle that need not be decided again
  float sx[kW], sy[kW], t_min[kW], t_max[kW];
  std::uint32_t main_axis[kW];
  std::uint32_t leaf_count[kW], leaf_place[kW];  ///< blocks of the leaf that waits for its visit
  std::size_t ray[kW];
  std::uint32_t active;   ///< a bit for every lane that has a ray
  std::uint32_t waiting;  ///< a bit for every lane with a leaf to visit
  alignas(16) StackEntry stack[kW][kLaneStack];
};

/// V: lanes of the walk. B: lanes of a leaf block, dividing kLeafWidth. Twice: lanes of two
/// neighbouring blocks, or B again.
template <class V, class B, class Twice, int kLeafWidth, bool kAnyHit, std::size_t kGroups>
class LaneWalk {
 public:
  LaneWalk(const LaneQuery& query, LaneCounts& counts)
      : query_(query), counts_(counts), source_(query) {}

  void run() {
    std::uint32_t active = 0;
    for (Group& group : groups_) {
      clear(group);
      for (std::uint32_t lane = 0; lane < V::kWidth; ++lane) take_ray(group, lane);
      active |= group.active;
    }
    while (active != 0) {
      active = 0;
      for (Group& group : groups_) {
        if (group.active == 0) continue;
        step(group);
        active |= group.active;
      }
    }
    counts_.unusable_rays += source_.unusable();
  }

 private:
  using F = typename V::F;
  using I = typename V::I;
  using M = typename V::M;
  using Group = LaneGroup<V>;
  static constexpr bool kTwice = Twice::kWidth == 2 * B::kWidth;
  static constexpr std::size_t kBlockFloats = 10 * kLeafWidth;
  static constexpr std::uint32_t kEntryBytes = sizeof(StackEntry);
  static constexpr std::uint32_t kEmptyLeaf = 1;  ///< nodes[1] of every tree

  static void clear(Group& group) {
    const F zero = V::set1(0.0F);
    float* const state[] = {group.t0,       group.t1,       group.o[0],     group.o[1],
                            group.o[2],     group.inv_d[0], group.inv_d[1], group.inv_d[2],
                            group.slack};
    for (float* const floats : state) V::store(floats, zero);
    V::store(group.stack_size, V::set1(0U));
    V::store(group.node, V::set1(kEmptyLeaf));
    V::store(group.leaf_count, V::set1(0U));
    V::store(group.leaf_place, V::set1(0U));
    group.active = group.waiting = 0;
  }

  // Gives the lane the next ray, or parks it.
  [[gnu::noinline]] void take_ray(Group& group, std::uint32_t lane) {
    std::size_t place = 0;
    std::size_t index = 0;
    group.stack_size[lane] = 0;
    if (!source_.next(place, index)) {
      group.node[lane] = kEmptyLeaf;
      group.active &= ~(1U << lane);
      return;
    }
    const ReadyRays<V>& ready = source_.ready();
    for (std::size_t k = 0; k < 3; ++k) {
      group.o[k][lane] = ready.o[k][place];
      group.inv_d[k][lane] = ready.inv_d[k][place];
    }
    group.slack[lane] = ready.slack[place];
    group.t0[lane] = ready.t0[place];
    group.t1[lane] = ready.t1[place];
    group.sx[lane] = ready.sx[place];
    group.sy[lane] = ready.sy[place];
    group.t_min[lane] = ready.t_min[place];
    group.t_max[lane] = ready.t_max[place];
    group.main_axis[lane] = ready.main_axis[place];
    group.limit[lane] = kEndless;
    group.known[lane] = kLaneNoHit;
    group.ray[lane] = index;
    group.node[lane] = 0;
    group.active |= 1U << lane;
  }

  // A leaf with triangles is visited in the turn after the one that finds it: its block has the
  // other groups' time to come from memory. Meanwhile the lane stands at an empty leaf.
  void step(Group& group) {
    const std::uint32_t waiting = group.waiting;
    const Leaves found = descend(group);
    const std::uint32_t walking = group.active & ~waiting;
    const std::uint32_t leaves = found.all & walking;
    const auto in_leaf = static_cast<std::uint32_t>(__builtin_popcount(leaves));
    counts_.lane_slots += V::kWidth;
    counts_.node_steps += static_cast<std::uint32_t>(__builtin_popcount(walking)) - in_leaf;
    counts_.leaf_visits += in_leaf;
    group.waiting = found.filled & walking;
    prefetch_blocks(group);
    for (std::uint32_t rest = waiting; rest != 0; rest &= rest - 1) {
      const auto lane = static_cast<std::uint32_t>(__builtin_ctz(rest));
      if (visit_leaf(group, lane) || !pop(group, lane)) take_ray(group, lane);
    }
    for (std::uint32_t rest = leaves & ~found.filled; rest != 0; rest &= rest - 1) {
      const auto lane = static_cast<std::uint32_t>(__builtin_ctz(rest));
      if (!pop(group, lane)) take_ray(group, lane);
    }
    V::prefetch_nodes(query_.nodes, group.node);
  }

  void prefetch_blocks(const Group& group) const {
    for (std::uint32_t rest = group.waiting; rest != 0; rest &= rest - 1) {
      const auto lane = static_cast<std::uint32_t>(__builtin_ctz(rest));
      const float* block = query_.blocks + kBlockFloats * group.leaf_place[lane];
      for (std::size_t line = 0; line < kBlockFloats; line += 16) __builtin_prefetch(block + line);
    }
  }

  struct Leaves {
    std::uint32_t all, filled;  ///< a bit a lane: at a leaf; at one that has triangles
  };

  // Lanes at an inner node go to a child, see ScalarWalk::descend.
  Leaves descend(Group& group) {
    I word, place;
    V::load_nodes(query_.nodes, group.node, word, place);
    const I axis = V::both(place, V::set1(3U));
    const I index = V::template shift_right<2>(place);
    const M leaf = V::eq(axis, V::set1(3U));
    const M filled = V::not_but(V::eq(word, V::set1(0U)), leaf);
    V::store(group.leaf_count, V::blend(filled, V::load(group.leaf_count), word));
    V::store(group.leaf_place, V::blend(filled, V::load(group.leaf_place), index));
    const F o = V::select(axis, V::load(group.o[0]), V::load(group.o[1]), V::load(group.o[2]));
    const F inv_d = V::select(axis, V::load(group.inv_d[0]), V::load(group.inv_d[1]),
                              V::load(group.inv_d[2]));
    const F distance = V::sub(V::as_float(word), o);
    const F wide = V::add(V::load(group.slack),
                          V::mul(V::set1(kRelativeSlack), V::abs(distance)));
    const F widen = V::turn_sign(wide, inv_d);
    const F leave_near = V::mul(V::add(distance, widen), inv_d);
    const F enter_far = V::mul(V::sub(distance, widen), inv_d);
    const I near = V::add(index, V::template shift_right<31>(V::as_int(inv_d)));
    const I far = V::flip(near, V::set1(1U));
    const F t0 = V::load(group.t0);
    const F t1 = V::load(group.t1);
    const F far_t0 = V::max(enter_far, t0);
    const M only_far = V::lt(leave_near, t0);
    const M push = V::not_but(V::either(leaf, only_far), V::not_gt(enter_far, t1));
    V::store_entries(reinterpret_cast<unsigned char*>(group.stack), sizeof group.stack[0],
                     group.stack_size, far, far_t0, t1);
    V::store(group.stack_size,
             V::add_where(push, V::load(group.stack_size), V::set1(kEntryBytes)));
    V::store(group.node,
             V::blend(leaf, V::blend(only_far, near, far), V::set1(kEmptyLeaf)));
    V::store(group.t0, V::blend(only_far, t0, far_t0));
    V::store(group.t1, V::blend(only_far, V::min(leave_near, t1), t1));
    return {V::bits(leaf), V::bits(filled)};
  }

  // To the next cell on the lane's stack that is not beyond its limit. False if there is none.
  static bool pop(Group& group, std::uint32_t lane) {
    const float limit = group.limit[lane];
    for (std::uint32_t size = group.stack_size[lane] / kEntryBytes; size != 0;) {
      const StackEntry& entry = group.stack[lane][--size];
      if (limit < entry.t0) continue;
      group.node[lane] = entry.node;
      group.t0[lane] = entry.t0;
      group.t1[lane] = entry.t1;
      group.stack_size[lane] = size * kEntryBytes;
      return true;
    }
    return false;
  }

  // True when the ray is done.
  bool visit_leaf(Group& group, std::uint32_t lane) {
    const float* const first = query_.blocks + kBlockFloats * group.leaf_place[lane];
    const std::uint32_t count = group.leaf_count[lane];
    std::uint32_t b = 0;
    if constexpr (kTwice) {
      if (count > 1) {
        const auto ray = filter_ray<Twice>(group, lane);
        for (; b + 1 < count; b += 2) {
          const auto both = candidates<Twice>(ray, first + kBlockFloats * b, group.known[lane]);
          ++counts_.block_tests;
          if (decide(group, lane, b, both & 0xFFU)) return true;
          ++counts_.block_tests;
          if (decide(group, lane, b + 1, both >> 8)) return true;
        }
      }
      if (b == count) return false;
    }
    const auto ray = filter_ray<B>(group, lane);
    for (; b < count; ++b) {
      ++counts_.block_tests;
      const float* const block = first + kBlockFloats * b;
      std::uint32_t found = 0;
      for (std::uint32_t at = 0; at < kLeafWidth; at += B::kWidth) {
        found |= candidates<B>(ray, block + at, group.known[lane]) << at;
      }
      if (decide(group, lane, b, found)) return true;
    }
    return false;
  }

  // The last word on the candidates of the b-th block of the lane's leaf. True when the ray is done.
  bool decide(Group& group, std::uint32_t lane, std::uint32_t b, std::uint32_t found) {
    if (found == 0) return false;
    const LaneBest best =
        query_.decide(query_.context, group.ray[lane], group.leaf_place[lane] + b, found);
    if (kAnyHit) return best.id != kLaneNoHit;
    group.limit[lane] = best.t;
    if (best.t < group.t_max[lane]) group.t_max[lane] = best.t;
    group.known[lane] = best.id;
    return false;
  }

  template <class L>
  static FilterRay<L> filter_ray(const Group& group, std::uint32_t lane) {
    const std::size_t z = group.main_axis[lane];
    const std::size_t x = z == 2 ? 0 : z + 1;
    const std::size_t y = x == 2 ? 0 : x + 1;
    return {L::set1(group.o[x][lane]), L::set1(group.o[y][lane]), L::set1(group.o[z][lane]),
            L::set1(group.sx[lane]),   L::set1(group.sy[lane]),   L::set1(group.inv_d[z][lane]),
            L::set1(group.t_min[lane]), L::set1(group.t_max[lane]),
            x * kLeafWidth,            y * kLeafWidth,            z * kLeafWidth};
  }

  // Those of a block, or of the part of it that begins at `block`, that have to be decided.
  template <class L>
  static std::uint32_t candidates(const FilterRay<L>& ray, const float* block,
                                  std::uint32_t known) {
    constexpr std::size_t kIds = 9 * kLeafWidth;
    const std::uint32_t lanes = may_be_hit<L, kLeafWidth>(ray, block);
    if (lanes == 0) return 0;
    return lanes & worth_deciding<L>(reinterpret_cast<const std::uint32_t*>(block + kIds), known);
  }

  const LaneQuery& query_;
  LaneCounts& counts_;
  RaySource<V> source_;
  Group groups_[kGroups];
};

}  // namespace
}  // namespace raykiln::render
