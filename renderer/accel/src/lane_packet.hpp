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
    turn_ = n_walking_ = n_waiting_ = 0;
    for (; chosen != 0; chosen &= chosen - 1) {
      const auto i = static_cast<std::uint32_t>(__builtin_ctz(chosen));
      begin(packets_[i], batches[i]);
      go_on({packets_ + i, batches + i});
    }
    const auto* const nodes = static_cast<const Node*>(query_.nodes);
    while (n_walking_ + n_waiting_ != 0) {
      std::uint32_t due = n_waiting_;
      std::uint32_t leaves = 0;  // the last packet's bit is the lowest
      const Walker* const end = walking_ + n_walking_;
      for (const Walker* walker = walking_; walker != end; ++walker) {
        leaves = 2 * leaves + step(*walker->packet, *walker->rays, nodes);
      }
      ++turn_;
      for (std::uint32_t last = n_walking_ - 1; leaves != 0; leaves &= leaves - 1) {
        const std::uint32_t i = last - static_cast<std::uint32_t>(__builtin_ctz(leaves));
        const Walker walker = walking_[i];
        walking_[i] = walking_[--n_walking_];
        count_steps(*walker.packet);
        go_on(walker);
      }
      if (at_once_) due = n_waiting_;
      for (std::uint32_t i = 0; i < due; ++i) visit_leaf(waiting_[i]);
      n_waiting_ -= due;
      for (std::uint32_t i = 0; i < n_waiting_; ++i) waiting_[i] = waiting_[due + i];
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
    std::int32_t credit;  ///< of steps that many took part in; the packet stops when it is used up
    std::uint32_t taken;  ///< rays in steps that are not counted yet
    std::uint32_t since;  ///< the turn of the first of these steps
    Cell stack[kLaneStack];
  };
  struct Walker {
    Packet* packet;
    Batch* rays;
  };
  /// Half of the lanes shall take part, or a step is cheaper for each ray in a lane of its own.
  static constexpr std::int32_t kLeastShare = 2;
  static constexpr std::int32_t kFirstCredit = 7 * kW / 2;
  static constexpr std::int32_t kMostCredit = 7 * kW;
  static constexpr std::size_t kBlockFloats = Leaf::kBlockFloats;

  static void begin(Packet& packet, const Batch& rays) {
    V::store(packet.now.t0, V::load(rays.t0));
    V::store(packet.now.t1, V::load(rays.t1));
    packet.now.node = 0;
    packet.now.lanes = rays.waiting;
    packet.size = 0;
    packet.credit = kFirstCredit;
    packet.taken = 0;
    packet.since = 0;
  }

  // A packet that may be at a leaf: to the next inner node, where it walks on; or to a leaf with
  // triangles, where it waits a turn for their blocks to be fetched; or to its end.
  void go_on(const Walker& walker) {
    const auto* const nodes = static_cast<const Node*>(query_.nodes);
    Packet& packet = *walker.packet;
    do {
      const Node node = nodes[packet.now.node];
      if ((node.place & 3U) != 3U) {
        if (packet.credit < least_credit_) {
          stop(packet, *walker.rays);
        } else {
          packet.since = turn_;
          walking_[n_walking_++] = walker;
        }
        return;
      }
      if (node.word != 0) {
        if (!at_once_) {
          fetch_leaf<V, kBlockFloats>(query_.blocks + kBlockFloats * (node.place >> 2), node.word);
        }
        waiting_[n_waiting_++] = walker;
        return;
      }
      count_visit(packet);
    } while (pop(packet, *walker.rays));
  }

  // The leaf whose blocks were fetched in the turn before.
  void visit_leaf(const Walker& walker) {
    Packet& packet = *walker.packet;
    Batch& rays = *walker.rays;
    const Node node = static_cast<const Node*>(query_.nodes)[packet.now.node];
    count_visit(packet);
    rays.waiting &= ~leaf_.packet(rays, packet.now.lanes, node.place >> 2, node.word);
    if (pop(packet, rays)) go_on(walker);
  }

  void count_visit(Packet& packet) const {
    const auto n = static_cast<std::uint32_t>(__builtin_popcount(packet.now.lanes));
    counts_.leaf_visits += n;
    counts_.lane_slots += kW;
    packet.credit += static_cast<std::int32_t>(n * kLeastShare - kW);
  }

  // The steps since the packet began to walk on.
  void count_steps(Packet& packet) const {
    const std::uint32_t slots = (turn_ - packet.since) * static_cast<std::uint32_t>(kW);
    counts_.node_steps += packet.taken;
    counts_.lane_slots += slots;
    const std::int32_t then =
        packet.credit + static_cast<std::int32_t>(packet.taken * kLeastShare - slots);
    packet.credit = then < kMostCredit ? then : kMostCredit;
    packet.taken = 0;
  }

  // One step, see ScalarWalk::descend; 1 when it leads to a leaf. Without a branch, on the rays or
  // else: one that is guessed wrongly would throw away what the processor has begun for the packets
  // that follow. What lanes that take no part get is of no account, nor what is stored above the top
  // of the stack.
  static std::uint32_t step(Packet& packet, const Batch& rays, const Node* nodes) {
    const Node node = nodes[packet.now.node];
    const std::size_t axis = node.place & 3U;
    float split;
    __builtin_memcpy(&split, &node.word, sizeof split);
    const F t0 = V::load(packet.now.t0);
    const F t1 = V::load(packet.now.t1);
    const F inv_d = V::load(rays.inv_d[axis]);
    const F distance = V::sub(V::set1(split), V::load(rays.o[axis]));
    const F wide =
        V::add(V::load(rays.slack), V::mul(V::set1(kRelativeSlack), V::abs(distance)));
    const F widen = V::turn_sign(wide, inv_d);
    const F leave_near = V::mul(V::add(distance, widen), inv_d);
    const F enter_far = V::mul(V::sub(distance, widen), inv_d);
    const F far_t0 = V::max(enter_far, t0);
    const M only_far = V::lt(leave_near, t0);
    const std::uint32_t lanes = packet.now.lanes;
    const std::uint32_t to_far = lanes & V::bits(V::either(only_far, V::not_gt(enter_far, t1)));
    const std::uint32_t to_near = lanes & ~V::bits(only_far);
    const std::uint32_t none_near = (to_near - 1U) >> 31;
    const std::uint32_t none_far = (to_far - 1U) >> 31;
    const std::uint32_t near = (node.place >> 2) + rays.backward[axis];
    Cell& kept = packet.stack[packet.size];
    V::store(kept.t0, far_t0);
    V::store(kept.t1, t1);
    kept.node = near ^ 1U;
    kept.lanes = to_far;
    packet.size += 1U - (none_near | none_far);
    packet.taken += static_cast<std::uint32_t>(__builtin_popcount(lanes));
    V::store(packet.now.t0, V::blend(only_far, t0, far_t0));
    V::store(packet.now.t1, V::blend(only_far, V::min(leave_near, t1), t1));
    const std::uint32_t at = near ^ none_near;
    packet.now.node = at;
    packet.now.lanes = to_near | (to_far & (0U - none_near));
    return ((nodes[at].place & 3U) + 1U) >> 2;
  }

  // To the next cell that a ray has to visit. False when there is none.
  bool pop(Packet& packet, Batch& rays) const {
    while (packet.size > 0) {
      const Cell& cell = packet.stack[--packet.size];
      const F t0 = V::load(cell.t0);
      const std::uint32_t beyond = V::bits(V::lt(V::load(rays.limit), t0));
      const std::uint32_t met = cell.lanes & rays.waiting & ~beyond;
      if (met == 0) continue;
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
  static void stop(Packet& packet, Batch& rays) {
    packet.stack[packet.size++] = packet.now;
    std::uint32_t lanes = 0;
    for (std::uint32_t i = 0; i < packet.size; ++i) lanes |= packet.stack[i].lanes;
    rays.waiting &= lanes;
  }

  const LaneQuery& query_;
  LaneCounts& counts_;
  const Leaf& leaf_;
  const bool at_once_ = query_.node_count <= V::kCachedNodes;  ///< leaves do not wait
  std::int32_t least_credit_ = 0;
  std::uint32_t turn_ = 0;
  std::uint32_t n_walking_ = 0;
  std::uint32_t n_waiting_ = 0;
  Walker walking_[kPackets];  ///< at inner nodes
  Walker waiting_[2 * kPackets];  ///< at leaves; those due and those found meanwhile
  Packet packets_[kPackets];
};

}  // namespace
}  // namespace raykiln::render
