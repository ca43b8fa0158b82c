// The walk of scalar_walk.hpp in lanes: every lane has a ray and a node of its own, all lanes of a
// group take a step together, and a lane whose ray is done takes the next one. A leaf is done for
// one ray, against all triangles of a block at once. Several groups take turns, so that the nodes
// that one waits for arrive while others work.
//
// Rays that go together for long begin as a packet, see lane_packet.hpp.
//
// Each ray sees the same cells in the same order with the same roundings as in the scalar walk, so
// counts of steps, visits and blocks are equal, too.
//
// Included by one unit per instruction set: internal linkage only, no standard library.
#pragma once

#include <cstddef>
#include <cstdint>

#include "lane_packet.hpp"
#include "lane_query.hpp"
#include "lane_setup.hpp"
#include "lane_sorted.hpp"
#include "walk_limits.hpp"

namespace raykiln::render {
namespace {

struct StackEntry {
  std::uint32_t node;
  float t0, t1, unused;
};

template <class V>
struct LaneGroup : LeafRays<V::kWidth> {
  static constexpr std::size_t kW = V::kWidth;
  std::uint32_t node[kW];
  float t0[kW], t1[kW], slack[kW];
  std::uint32_t stack_size[kW];  ///< in bytes
  std::uint32_t leaf_count[kW], leaf_place[kW];  ///< blocks of the leaf that waits for its visit
  std::size_t ray[kW];
  std::uint32_t active;   ///< a bit for every lane that has a ray
  std::uint32_t waiting;  ///< a bit for every lane with a leaf to visit
  alignas(16) StackEntry stack[kW][kLaneStack];
};

/// V: lanes of the walk. Leaf: what is done at a leaf, LeafVisit or FastLeafVisit.
template <class V, class Leaf, bool kAnyHit, std::size_t kGroups>
class LaneWalk {
 public:
  LaneWalk(const LaneQuery& query, LaneCounts& counts)
      : query_(query), counts_(counts), source_(query), leaf_(query, counts),
        packet_(query, counts, leaf_) {}

  void run() {
    if (query_.node_count <= kFewNodes) {
      SortedWalk<V, Source, Packets, kPackets> sorted(query_, source_, packet_);
      sorted.run();
    } else {
      walk();
    }
    counts_.unusable_rays += source_.unusable();
  }

 private:
  using F = typename V::F;
  using I = typename V::I;
  using M = typename V::M;
  using Group = LaneGroup<V>;
  static constexpr std::uint32_t kPackets = 8;
  using Source = RaySource<V, Leaf, kPackets>;
  using Packets = PacketWalk<V, Leaf, kPackets>;
  static constexpr std::size_t kBlockFloats = Leaf::kBlockFloats;
  static constexpr std::uint32_t kEntryBytes = sizeof(StackEntry);
  static constexpr std::uint64_t kStepsWorthIt = 12;  ///< of a ray with others
  /// Of a tree that is best walked by sorted rays.
  static constexpr std::uint64_t kFewNodes = kAnyHit ? 16 * V::kWidth : 32;
  static constexpr std::uint32_t kEmptyLeaf = 1;  ///< nodes[1] of every tree

  void walk() {
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
  }

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
    do {
      std::size_t place = 0;
      const bool found = source_.next(
          place, group.ray[lane],
          [this](ReadyRays<V>* batches, std::uint32_t chosen) {
            return walk_together(batches, chosen);
          });
      group.stack_size[lane] = 0;
      if (!found) {
        group.node[lane] = kEmptyLeaf;
        group.active &= ~(1U << lane);
        return;
      }
      begin(group, lane, place);
    } while (source_.batch().begun && !pop(group, lane));
    group.active |= 1U << lane;
  }

  // True if packets did more for the rays than to delay them: any-hit rays are quick in lanes.
  bool walk_together(ReadyRays<V>* batches, std::uint32_t chosen) {
    const auto waiting = [&] {
      std::uint64_t rays = 0;
      for (std::uint32_t rest = chosen; rest != 0; rest &= rest - 1) {
        rays += static_cast<std::uint32_t>(
            __builtin_popcount(batches[__builtin_ctz(rest)].waiting));
      }
      return rays;
    };
    const std::uint64_t begun = waiting();
    const std::uint64_t steps = counts_.node_steps;
    packet_.walk(batches, chosen, false);
    return !kAnyHit || waiting() * 2 <= begun ||
           counts_.node_steps - steps >= kStepsWorthIt * begun;
  }

  // Puts a ray in a lane; one that was walked with others gets the cells left to it on the stack.
  void begin(Group& group, std::uint32_t lane, std::size_t place) const {
    const ReadyRays<V>& ready = source_.batch();
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
    group.limit[lane] = ready.limit[place];
    group.known[lane] = ready.known[place];
    if constexpr (Leaf::kHasEnds) group.end[lane] = ready.end[place];
    if constexpr (Leaf::kMoreSlack) group.tolerance[lane] = ready.tolerance[place];
    if constexpr (Leaf::kInDouble) {
      group.shear_x[lane] = ready.shear_x[place];
      group.shear_y[lane] = ready.shear_y[place];
      group.inv_dz[lane] = ready.inv_dz[place];
    }
    group.main_axis[lane] = ready.main_axis[place];
    group.node[lane] = 0;
    if (!ready.begun) return;
    const auto at = static_cast<std::uint32_t>(place);
    group.stack_size[lane] =
        packet_.hand_over(source_.batch_number(), at, group.stack[lane]) * kEntryBytes;
  }

  // A leaf with triangles is visited in the turn after the one that finds it: its block has the
  // other groups' time to come from memory. Meanwhile the lane stands at an empty leaf. In a tree that
  // caches hold there is nothing to wait for.
  void step(Group& group) {
    const std::uint32_t waiting = group.waiting;
    const Leaves found = descend(group);
    const std::uint32_t walking = group.active & ~waiting;
    const std::uint32_t leaves = found.all & walking;
    const auto in_leaf = static_cast<std::uint32_t>(__builtin_popcount(leaves));
    counts_.lane_slots += V::kWidth;
    counts_.node_steps += static_cast<std::uint32_t>(__builtin_popcount(walking)) - in_leaf;
    counts_.leaf_visits += in_leaf;
    const std::uint32_t filled = found.filled & walking;
    const std::uint32_t due = at_once_ ? filled : waiting;
    if (!at_once_) {
      group.waiting = filled;
      prefetch_blocks(group);
    }
    if constexpr (Leaf::kDecidesLater) {
      if (at_once_) {
        visit_leaves(group, due);
        go_on(group, leaves);
        return;
      }
    }
    visit_and_go_on(group, due);
    go_on(group, leaves & ~filled);
    if (!at_once_) V::prefetch_nodes(query_.nodes, group.node);
  }

  // One lane after the other: what is left of a leaf is decided while the next one is begun.
  [[gnu::always_inline]] void visit_and_go_on(Group& group, std::uint32_t lanes) {
    for (; lanes != 0; lanes &= lanes - 1) {
      const auto lane = static_cast<std::uint32_t>(__builtin_ctz(lanes));
      if (visit_leaf(group, lane) || !pop(group, lane)) take_ray(group, lane);
    }
  }

  // All leaves are filtered before any is decided.
  [[gnu::always_inline]] void visit_leaves(Group& group, std::uint32_t lanes) {
    typename Leaf::Asked asked[2 * V::kWidth + 1];
    std::uint32_t n = 0;
    for (; lanes != 0; lanes &= lanes - 1) {
      const auto lane = static_cast<std::uint32_t>(__builtin_ctz(lanes));
      const std::uint32_t count = group.leaf_count[lane];
      if (count <= Leaf::kMostFiltered) {
        n += leaf_.filter(group, lane, group.leaf_place[lane], count, asked + n);
      } else {
        visit_leaf(group, lane);
      }
    }
    for (std::uint32_t i = 0; i < n; ++i) leaf_.decide(group, asked[i], group.ray[asked[i].lane]);
  }

  [[gnu::always_inline]] void go_on(Group& group, std::uint32_t lanes) {
    for (; lanes != 0; lanes &= lanes - 1) {
      const auto lane = static_cast<std::uint32_t>(__builtin_ctz(lanes));
      if (!pop(group, lane)) take_ray(group, lane);
    }
  }

  [[gnu::always_inline]] void prefetch_blocks(const Group& group) const {
    for (std::uint32_t rest = group.waiting; rest != 0; rest &= rest - 1) {
      const auto lane = static_cast<std::uint32_t>(__builtin_ctz(rest));
      fetch_leaf<V, kBlockFloats>(query_.blocks + kBlockFloats * group.leaf_place[lane],
                                  group.leaf_count[lane]);
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
    return leaf_.one_ray(group, lane, group.ray[lane], group.leaf_place[lane],
                         group.leaf_count[lane]);
  }

  const LaneQuery& query_;
  LaneCounts& counts_;
  Source source_;
  Leaf leaf_;
  Packets packet_;
  const bool at_once_ = query_.node_count <= V::kCachedNodes;  ///< leaves do not wait, nothing is fetched ahead
  Group groups_[kGroups];
};

}  // namespace
}  // namespace raykiln::render
