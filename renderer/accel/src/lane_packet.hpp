// The walk of scalar_walk.hpp for rays that go together: one node for all of them, an interval for
// each. The rays have the same signs of direction, so that the near child is the same for all, and
// the same main axis. A ray takes part in a step when the scalar walk would make it, with the same
// roundings: counts of steps, visits and blocks are equal, too. Several packets take turns: a step
// is a chain of few instructions that waits for a node.
//
// When too few rays take part, a packet stops, and each ray goes on in a lane of its own with the
// cells that are left to it. Internal linkage only.
#pragma once

#include <cstddef>
#include <cstdint>

#include "lane_query.hpp"
#include "lane_setup.hpp"
#include "walk_limits.hpp"

namespace raykiln::render {
namespace {

template <class V, class Leaf, std::uint32_t kPackets>
class PacketWalk {
 public:
  static constexpr std::size_t kW = V::kWidth;
  using Batch = ReadyRays<V>;

  PacketWalk(const LaneQuery& query, LaneCounts& counts, const Leaf& leaf)
      : query_(query), counts_(counts), leaf_(leaf) {}

  /// Walks the rays of the batches whose bits are in `chosen`; leaves those waiting that are not
  /// done yet: none if they are to stay together `to_the_end`.
  void walk(Batch* batches, std::uint32_t chosen, bool to_the_end) {
    least_credit_ = to_the_end ? -(1 << 30) : 0;
    for (std::uint32_t rest = chosen; rest != 0; rest &= rest - 1) {
      const auto i = static_cast<std::uint32_t>(__builtin_ctz(rest));
      begin(packets_[i], batches[i]);
    }
    struct Walker {
      Packet* packet;
      Batch* rays;
    };
    Walker walkers[kPackets];
    std::uint32_t n = 0;
    for (; chosen != 0; chosen &= chosen - 1) {
      const auto i = static_cast<std::uint32_t>(__builtin_ctz(chosen));
      walkers[n++] = {packets_ + i, batches + i};
    }
    while (n != 0) {
      for (std::uint32_t i = 0; i < n;) {
        if (step(*walkers[i].packet, *walkers[i].rays)) {
          ++i;
        } else {
          walkers[i] = walkers[--n];
        }
      }
    }
  }

  /// Puts the cells left to the ray of `lane` of a batch on `stack`, the next one last; says how many.
  template <typename Entry>
  std::uint32_t hand_over(std::uint32_t batch, std::uint32_t lane, Entry* stack) const {
    const Packet& packet = packets_[batch];
    std::uint32_t n = 0;
    for (std::uint32_t i = 0; i < packet.size; ++i) {
      const Cell& cell = packet.stack[i];
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
  struct Packet {
    Cell now;
    std::uint32_t size;   ///< cells on the stack
    bool fetched;         ///< the leaf's block is on its way
    std::int32_t credit;  ///< of steps that many took part in; the packet stops when it is used up
    Cell stack[kLaneStack];
  };
  /// Half of the lanes shall take part, or a step is cheaper for each ray in a lane of its own.
  static constexpr std::int32_t kLeastShare = 2;
  /// Two in a row keep intervals in registers between them; the other packets' turns hide the rest.
  static constexpr std::uint32_t kStepsATurn = 2;
  static constexpr std::int32_t kFirstCredit = 4 * kW;
  static constexpr std::int32_t kMostCredit = 8 * kW;
  static constexpr std::size_t kBlockFloats = Leaf::kBlockFloats;

  static void begin(Packet& packet, const Batch& rays) {
    V::store(packet.now.t0, V::load(rays.t0));
    V::store(packet.now.t1, V::load(rays.t1));
    packet.now.node = 0;
    packet.now.lanes = rays.waiting;
    packet.size = 0;
    packet.fetched = false;
    packet.credit = kFirstCredit;
  }

  // One cell further. False when the packet is at its end.
  bool step(Packet& packet, Batch& rays) {
    const auto* const nodes = static_cast<const Node*>(query_.nodes);
    const Node node = nodes[packet.now.node];
    if ((node.place & 3U) != 3U) {
      if (packet.credit < least_credit_) return stop(packet, rays);
      descend_some(packet, rays, node);
      __builtin_prefetch(nodes + packet.now.node);
      return true;
    }
    if (node.word != 0 && !packet.fetched) {
      fetch(node.place >> 2);
      packet.fetched = true;
      return true;
    }
    packet.fetched = false;
    count_visit(packet, packet.now.lanes);
    if (node.word != 0) {
      rays.waiting &= ~leaf_.packet(rays, packet.now.lanes, node.place >> 2, node.word);
    }
    return pop(packet, rays);
  }

  void count_visit(Packet& packet, std::uint32_t lanes) const {
    const std::int32_t n = __builtin_popcount(lanes);
    counts_.leaf_visits += static_cast<std::uint32_t>(n);
    counts_.lane_slots += kW;
    packet.credit = credit_after(packet.credit, n);
  }

  // A step that n rays took part in.
  static std::int32_t credit_after(std::int32_t credit, std::int32_t n) {
    const std::int32_t then = credit + n * kLeastShare - static_cast<std::int32_t>(kW);
    return then < kMostCredit ? then : kMostCredit;
  }

  void fetch(std::size_t block) const {
    const float* const first = query_.blocks + kBlockFloats * block;
    for (std::size_t line = 0; line < kBlockFloats; line += 16) __builtin_prefetch(first + line);
  }

  // Steps from `node` on, as many as a turn has, up to a leaf. See ScalarWalk::descend. Without a
  // branch on the rays: what lanes that take no part get is of no account.
  void descend_some(Packet& packet, const Batch& rays, Node node) {
    const auto* const nodes = static_cast<const Node*>(query_.nodes);
    const F slack = V::load(rays.slack);
    F t0 = V::load(packet.now.t0);
    F t1 = V::load(packet.now.t1);
    std::uint32_t lanes = packet.now.lanes;
    std::uint32_t at = 0;
    std::uint32_t taken = 0;
    std::uint32_t steps = 0;
    std::int32_t credit = packet.credit;
    Cell* kept = packet.stack + packet.size;
    do {
      const std::int32_t n = __builtin_popcount(lanes);
      taken += static_cast<std::uint32_t>(n);
      credit = credit_after(credit, n);
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
      const M only_far = V::lt(leave_near, t0);
      const std::uint32_t far_alone = V::bits(only_far);
      const std::uint32_t to_far = lanes & (far_alone | V::bits(V::not_gt(enter_far, t1)));
      const std::uint32_t to_near = lanes & ~far_alone;
      const std::uint32_t near = (node.place >> 2) + rays.backward[axis];
      V::store(kept->t0, far_t0);
      V::store(kept->t1, t1);
      kept->node = near ^ 1U;
      kept->lanes = to_far;
      kept += to_near != 0 && to_far != 0 ? 1U : 0U;
      t0 = V::blend(only_far, t0, far_t0);
      t1 = V::blend(only_far, V::min(leave_near, t1), t1);
      at = near ^ (to_near == 0 ? 1U : 0U);
      lanes = to_near == 0 ? to_far : to_near;
      node = nodes[at];
      ++steps;
    } while (steps < kStepsATurn && (node.place & 3U) != 3U);
    counts_.node_steps += taken;
    counts_.lane_slots += std::uint64_t{steps} * kW;
    packet.credit = credit;
    packet.size = static_cast<std::uint32_t>(kept - packet.stack);
    V::store(packet.now.t0, t0);
    V::store(packet.now.t1, t1);
    packet.now.node = at;
    packet.now.lanes = lanes;
  }

  // To the next cell that a ray has to visit and that is no empty leaf. False when there is none.
  bool pop(Packet& packet, Batch& rays) const {
    const auto* const nodes = static_cast<const Node*>(query_.nodes);
    while (packet.size > 0) {
      const Cell& cell = packet.stack[--packet.size];
      const F t0 = V::load(cell.t0);
      const std::uint32_t beyond = V::bits(V::lt(V::load(rays.limit), t0));
      const std::uint32_t met = cell.lanes & rays.waiting & ~beyond;
      if (met == 0) continue;
      const Node node = nodes[cell.node];
      if (node.word == 0 && (node.place & 3U) == 3U) {
        count_visit(packet, met);
        continue;
      }
      V::store(packet.now.t0, t0);
      V::store(packet.now.t1, V::load(cell.t1));
      packet.now.node = cell.node;
      packet.now.lanes = met;
      return true;
    }
    rays.waiting = 0;
    return false;
  }

  // Too few rays go together: what is left is handed over.
  static bool stop(Packet& packet, Batch& rays) {
    packet.stack[packet.size++] = packet.now;
    std::uint32_t lanes = 0;
    for (std::uint32_t i = 0; i < packet.size; ++i) lanes |= packet.stack[i].lanes;
    rays.waiting &= lanes;
    return false;
  }

  const LaneQuery& query_;
  LaneCounts& counts_;
  const Leaf& leaf_;
  std::int32_t least_credit_ = 0;
  Packet packets_[kPackets];
};

}  // namespace
}  // namespace raykiln::render
