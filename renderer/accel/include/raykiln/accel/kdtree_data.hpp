// The arrays of a kd-tree, for the walks, for tests and for storing a tree on disk.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "raykiln/accel/kdtree.hpp"

namespace raykiln::render {

/// No tree is deeper, whatever BuildParams says: the stack of a walk has this many entries.
inline constexpr int kMaxKdDepth = 64;

/// W triangles as a structure of arrays: v[corner][axis][lane]. Lanes without a triangle hold one
/// repeated point and the id kNoHit; they fill the end of a leaf's last block only.
template <int W>
struct alignas(64) LeafBlock {
  static constexpr int kWidth = W;
  std::array<std::array<std::array<float, W>, 3>, 3> v;
  std::array<std::uint32_t, W> id;
};
static_assert(sizeof(LeafBlock<8>) == 320 && sizeof(LeafBlock<16>) == 640);

inline constexpr std::uint32_t kLeafAxis = 3;

[[nodiscard]] inline KdNode make_inner(std::uint32_t axis, float split, std::uint32_t left) {
  return {std::bit_cast<std::uint32_t>(split), left << 2 | axis};
}
[[nodiscard]] inline KdNode make_leaf(std::uint32_t blocks, std::uint32_t first_block) {
  return {blocks, first_block << 2 | kLeafAxis};
}
[[nodiscard]] inline bool is_leaf(KdNode n) { return (n.index_and_axis & 3U) == kLeafAxis; }
[[nodiscard]] inline std::uint32_t split_axis(KdNode n) { return n.index_and_axis & 3U; }
[[nodiscard]] inline float split_position(KdNode n) {
  return std::bit_cast<float>(n.split_or_count);
}
/// Index of the left child; the right one follows it.
[[nodiscard]] inline std::uint32_t left_child(KdNode n) { return n.index_and_axis >> 2; }
[[nodiscard]] inline std::uint32_t block_count(KdNode n) { return n.split_or_count; }
[[nodiscard]] inline std::uint32_t first_block(KdNode n) { return n.index_and_axis >> 2; }

/// Immutable once built. nodes[0] is the root and nodes[1] an unused empty leaf, so that every
/// sibling pair starts at an even index; a parent comes before its children.
class KdTree {
 public:
  Bounds3f box;  ///< of the triangles that are not degenerate; empty when there are none
  std::vector<KdNode> nodes;
  std::vector<LeafBlock<8>> blocks8;    ///< the leaves when params.leaf_width is 8
  std::vector<LeafBlock<16>> blocks16;  ///< the leaves when it is 16
  std::vector<std::uint64_t> opaque_bits;  ///< one bit a triangle; empty: all are opaque
  BuildParams params;                      ///< as used, out-of-range values replaced
  BuildStats stats;
  /// The mesh as given, for the brute force search alone, which must not depend on the leaves.
  std::vector<Vec3f> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;

  [[nodiscard]] bool opaque(std::uint32_t id) const {
    return opaque_bits.empty() || ((opaque_bits[id >> 6] >> (id & 63U)) & 1U) != 0;
  }
};

/// Calls visit(blocks) with the vector of leaf blocks that the tree uses.
template <typename Visit>
decltype(auto) with_blocks(const KdTree& tree, Visit&& visit) {
  return tree.params.leaf_width == 16 ? visit(tree.blocks16) : visit(tree.blocks8);
}

/// True when the three points lie on one line or coincide, decided exactly; such a triangle is
/// never hit. A triangle whose exact area is positive, however thin, gives false.
[[nodiscard]] bool has_zero_area(const Vec3f& p0, const Vec3f& p1, const Vec3f& p2);

}  // namespace raykiln::render
