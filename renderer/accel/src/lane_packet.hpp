// The walk of scalar_walk.hpp for rays that go together: one node for all of them, an interval for
// each. The rays have the same signs of direction, so that the near child is the same for all, and
// the same main axis. A ray takes part in a step when the scalar walk would make it, with the same
// roundings: counts of steps, visits and blocks are equal, too.
//
// When too few rays take part, the packet stops, and each ray goes on in a lane of its own with the
// cells that are left to it. Internal linkage only.
#pragma once

#include <cstddef>
#include <cstdint>

#include "lane_leaf.hpp"
#include "lane_query.hpp"
#include "lane_setup.hpp"
#include "walk_limits.hpp"

namespace raykiln::render {
namespace {

template <class V, class Leaf>
class PacketWalk {
 public:
  static constexpr std::size_t kW = V::kWidth;

  PacketWalk(const LaneQuery& query, LaneCounts& counts, const Leaf& leaf)
      : query_(query), counts_(counts), leaf_(leaf) {}

  /// Walks the rays of `lanes`, the first of which is `index` + its lane. A bit for each that is not
  /// done yet.
  std::uint32_t walk(ReadyRays<V>& rays, std::uint32_t lanes, std::size_t index) {
    std::uint32_t alive = lanes;
    std::uint64_t taken = 0;
    std::uint64_t possible = 0;
    size_ = 0;
    push(0, lanes, V::load(rays.t0), V::load(rays.t1));
    while (size_ > 0) {
      if (possible > kPatience && taken * kLeastShare < possible) return left() & alive;
      const Cell& cell = stack_[--size_];
      const F t0 = V::load(cell.t0);
      const std::uint32_t beyond = V::bits(V::lt(V::load(rays.limit), t0));
      const std::uint32_t met = cell.lanes & alive & ~beyond;
      if (met == 0) continue;
      alive &= ~visit(rays, met, index, cell.node, t0, V::load(cell.t1), taken, possible);
    }
    return 0;
  }

  /// Puts the cells left to the ray of `lane` on `stack`, the next one last; says how many.
  template <typename Entry>
  std::uint32_t hand_over(std::uint32_t lane, Entry* stack) const {
    std::uint32_t n = 0;
    for (std::uint32_t i = 0; i < size_; ++i) {
      const Cell& cell = stack_[i];
      if ((cell.lanes >> lane & 1U) != 0) {
        stack[n++] = {cell.node, cell.t0[lane], cell.t1[lane], 0.0F};
      }
    }
    return n;
  }

 private:
  using F = typename V::F;
  using M = typename V::M;
  struct Node {
    std::uint32_t word, place;
  };
  struct alignas(64) Cell {
    float t0[kW], t1[kW];
    std::uint32_t node, lanes;
  };
  static constexpr std::uint64_t kPatience = 24 * kW;  ///< steps of lanes before shares are judged
  static constexpr std::uint64_t kLeastShare = 2;      ///< a half of the lanes shall take part

  void push(std::uint32_t node, std::uint32_t lanes, F t0, F t1) {
    Cell& cell = stack_[size_++];
    V::store(cell.t0, t0);
    V::store(cell.t1, t1);
    cell.node = node;
    cell.lanes = lanes;
  }

  [[nodiscard]] std::uint32_t left() const {
    std::uint32_t lanes = 0;
    for (std::uint32_t i = 0; i < size_; ++i) lanes |= stack_[i].lanes;
    return lanes;
  }

  // Down to a leaf, see ScalarWalk::descend. A bit for each ray that is done there.
  std::uint32_t visit(ReadyRays<V>& rays, std::uint32_t lanes, std::size_t index,
                      std::uint32_t at, F t0, F t1, std::uint64_t& taken,
                      std::uint64_t& possible) {
    const auto* const nodes = static_cast<const Node*>(query_.nodes);
    const F slack = V::load(rays.slack);
    Node node = nodes[at];
    while ((node.place & 3U) != 3U) {
      const auto n = static_cast<std::uint32_t>(__builtin_popcount(lanes));
      counts_.node_steps += n;
      taken += n;
      possible += kW;
      counts_.lane_slots += kW;
      const std::size_t axis = node.place & 3U;
      float split;
      __builtin_memcpy(&split, &node.word, sizeof split);
      const F inv_d = V::load(rays.inv_d[axis]);
      const F distance = V::sub(V::set1(split), V::load(rays.o[axis]));
      const F wide = V::add(slack, V::mul(V::set1(kRelativeSlack), V::abs(distance)));
      const F widen = V::turn_sign(wide, inv_d);
      const F leave_near = V::mul(V::add(distance, widen), inv_d);
      const F enter_far = V::mul(V::sub(distance, widen), inv_d);
      const F far_t0 = V::max(enter_far, t0);
      const std::uint32_t only_far = V::bits(V::lt(leave_near, t0));
      const std::uint32_t reach_far = only_far | V::bits(V::not_gt(enter_far, t1));
      const std::uint32_t backward = rays.backward[axis];
      const std::uint32_t near = (node.place >> 2) + backward;
      const std::uint32_t to_far = lanes & reach_far;
      lanes &= ~only_far;
      if (lanes == 0) {
        lanes = to_far;
        t0 = far_t0;
        at = near ^ 1U;
      } else {
        if (to_far != 0) push(near ^ 1U, to_far, far_t0, t1);
        t1 = V::min(leave_near, t1);
        at = near;
      }
      node = nodes[at];
    }
    const auto n = static_cast<std::uint32_t>(__builtin_popcount(lanes));
    counts_.leaf_visits += n;
    taken += n;
    possible += kW;
    counts_.lane_slots += kW;
    return node.word == 0 ? 0 : leaf_.packet(rays, lanes, index, node.place >> 2, node.word);
  }

  const LaneQuery& query_;
  LaneCounts& counts_;
  const Leaf& leaf_;
  std::uint32_t size_ = 0;
  Cell stack_[kLaneStack];
};

}  // namespace
}  // namespace raykiln::render
