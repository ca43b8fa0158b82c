// Builds one subtree depth first on its own memory, so that tasks share nothing but the mesh.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "build_context.hpp"
#include "event_partition.hpp"
#include "sah_sweep.hpp"

namespace raykiln::render {

/// Nodes with at least this many triangles are worth tasks of their own.
inline constexpr std::size_t kParallelMin = 1U << 15;

/// A cell, its triangles and their sorted events. Events name a triangle by its index in `ids`,
/// which is ascending: so a new numbering keeps the order of the events, and the tree does not
/// depend on where it was cut into tasks.
struct SubtreeInput {
  Bounds3f cell;
  int depth = 0;
  std::uint64_t budget = 0;  ///< references that splits below may add
  double share = 1.0;        ///< of the whole build, for progress
  std::vector<std::uint32_t> ids;
  std::array<std::vector<EventKey>, 3> events;
};

/// A node before it has its final place.
struct BuildNode {
  enum class Kind : std::uint8_t { kLeaf, kInner, kLink };
  Kind kind = Kind::kLeaf;
  std::uint8_t axis = 0;
  float split = 0.0F;
  std::uint32_t a = 0;  ///< leaf: first reference; inner: left node; link: index of the subtree
  std::uint32_t b = 0;  ///< leaf: number of references; inner: right node
};

struct Subtree {
  std::vector<BuildNode> nodes;
  std::uint32_t root = 0;
  std::vector<std::uint32_t> references;          ///< triangle ids of the mesh, ascending in a leaf
  std::vector<std::unique_ptr<Subtree>> linked;   ///< built by other tasks
  BuildStats counts;                              ///< of this subtree alone, without linked ones
};

/// Depth cap of a tree of n triangles: min(max_depth, 8 + 1.3 lg n).
[[nodiscard]] int depth_cap(int max_depth, std::size_t n);

/// After a stop the result is a valid but useless subtree.
[[nodiscard]] std::unique_ptr<Subtree> build_subtree(BuildContext& context, SubtreeInput input,
                                                     int max_depth);

}  // namespace raykiln::render
