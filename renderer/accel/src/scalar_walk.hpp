// One ray through the tree, near cells first: the reference that every faster walk must equal.
//
// Why it finds what brute force finds. Let M be the largest coordinate of the root's box and the
// origin, u = 2^-24, w = 2^-53. The triangle test rounds sheared corners in double, which moves them
// by at most 12 w M; so when it reports a hit, a point of the exact triangle lies within 12 w M of
// the exact ray. That point lies, up to the rounding of clipping (some w M), in a leaf that lists
// the triangle. Cells are therefore taken to be larger by kAbsoluteSlack = 1024 w M on all sides, and
// by kRelativeSlack = 6 u of a face's distance: 4 for the roundings of the t of the face, 1 for that
// of the hit's t, 1 in reserve. Then the interval of some such leaf holds the reported t, and
// cells may be cut off by t_min, t_max and a best hit *strictly* before the entry; equal t goes on,
// so the lowest id wins.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "raykiln/accel/kdtree_data.hpp"
#include "triangle_test.hpp"

namespace raykiln::render {

class ScalarWalk {
 public:
  /// The ray has passed `prepare`. A test may need larger cells than the watertight one.
  template <class Test>
  ScalarWalk(const Test& /*test*/, const KdTree& tree, const Ray& ray, TraversalCounters& counters)
      : tree_(tree), counters_(counters) {
    float largest = 0.0F;
    for (int k = 0; k < 3; ++k) {
      const auto a = static_cast<std::size_t>(k);
      o_[a] = ray.o[k];
      inv_d_[a] = 1.0F / ray.d[k];
      backward_[a] = std::signbit(ray.d[k]);
      largest = std::max({largest, std::abs(o_[a]), std::abs(tree.box.lo[k]),
                          std::abs(tree.box.hi[k])});
    }
    slack_ = kAbsoluteSlack * largest;
    if constexpr (Test::kMoreSlack) slack_ = slack_ + Test::more_slack(tree.box, ray.o);
    t0_ = ray.t_min;
    t1_ = ray.t_max;
    clip_to_root();
  }

  /// Calls leaf(first block, count) for the cells along the ray until it returns true. `limit` is
  /// read anew before every cell: cells entered beyond it are left out.
  template <typename Leaf>
  void run(const float& limit, Leaf&& leaf) {
    if (!(t0_ <= t1_)) return;
    std::array<Entry, kMaxKdDepth + 1> stack;
    std::size_t size = 0;
    stack[size++] = {0, t0_, t1_};
    while (size > 0) {
      Entry cell = stack[--size];
      if (limit < cell.t0) continue;
      KdNode node = tree_.nodes[cell.node];
      while (!is_leaf(node)) {
        ++counters_.node_steps;
        cell = descend(node, cell, stack, size);
        node = tree_.nodes[cell.node];
      }
      ++counters_.leaf_visits;
      if (leaf(first_block(node), block_count(node))) return;
    }
  }

 private:
  struct Entry {
    std::uint32_t node;
    float t0, t1;
  };

  // The t at which the ray meets a plane moved down or up by the slack.
  [[nodiscard]] float below(float plane, std::size_t axis) const {
    const float distance = plane - o_[axis];
    return (distance - (slack_ + kRelativeSlack * std::abs(distance))) * inv_d_[axis];
  }
  [[nodiscard]] float above(float plane, std::size_t axis) const {
    const float distance = plane - o_[axis];
    return (distance + (slack_ + kRelativeSlack * std::abs(distance))) * inv_d_[axis];
  }

  // Comparisons are such that NaN (0 times infinity: the origin in a face of the enlarged cell and
  // no motion along the axis) keeps the interval as it is.
  void clip_to_root() {
    for (int k = 0; k < 3; ++k) {
      const auto a = static_cast<std::size_t>(k);
      const float lo = below(tree_.box.lo[k], a);
      const float hi = above(tree_.box.hi[k], a);
      const float enter = backward_[a] ? hi : lo;
      const float exit = backward_[a] ? lo : hi;
      if (enter > t0_) t0_ = enter;
      if (exit < t1_) t1_ = exit;
    }
  }

  // To the nearer child that the ray meets; the farther one, if met too, goes on the stack. NaN
  // means that both are met.
  template <typename Stack>
  Entry descend(KdNode node, const Entry& cell, Stack& stack, std::size_t& size) const {
    const std::size_t a = split_axis(node);
    const std::uint32_t left = left_child(node);
    const float low = below(split_position(node), a);
    const float high = above(split_position(node), a);
    const float leave_near = backward_[a] ? low : high;
    const float enter_far = backward_[a] ? high : low;
    const std::uint32_t near = left + (backward_[a] ? 1U : 0U);
    const std::uint32_t far = left + (backward_[a] ? 0U : 1U);
    const Entry far_cell{far, enter_far > cell.t0 ? enter_far : cell.t0, cell.t1};
    if (leave_near < cell.t0) return far_cell;
    const Entry near_cell{near, cell.t0, leave_near < cell.t1 ? leave_near : cell.t1};
    if (!(enter_far > cell.t1)) stack[size++] = far_cell;
    return near_cell;
  }

  const KdTree& tree_;
  TraversalCounters& counters_;
  std::array<float, 3> o_{}, inv_d_{};
  std::array<bool, 3> backward_{};
  float slack_ = 0.0F;
  float t0_ = 0.0F, t1_ = 0.0F;
};

}  // namespace raykiln::render
