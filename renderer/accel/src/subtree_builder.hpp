// Builds the tree of a cell before its nodes have places: large cells together, their work cut into
// tasks, and each small one depth first by a task of its own, which shares nothing but the mesh.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "build_context.hpp"
#include "plane_search.hpp"
#include "reference.hpp"

namespace raykiln::render {

/// Cells with fewer triangles are built by one task each.
inline constexpr std::size_t kParallelMin = 1U << 15;

/// References of a cell that one task takes at once, about.
inline constexpr std::size_t kRunSize = 1U << 14;

/// Some references of a cell; memory that is not cleared before it is written.
struct Run {
  std::unique_ptr<Reference[]> data;
  std::size_t size = 0;
  [[nodiscard]] std::span<const Reference> view() const { return {data.get(), size}; }
};

/// A cell and its references, `ascending` by triangle over all runs.
struct SubtreeInput {
  Bounds3f cell;
  int depth = 0;
  std::uint64_t budget = 0;  ///< references that splits below may add
  double share = 1.0;        ///< of the whole build, for progress
  std::vector<Run> runs;

  [[nodiscard]] std::size_t size() const {
    std::size_t n = 0;
    for (const Run& run : runs) n += run.size;
    return n;
  }
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
  std::vector<std::unique_ptr<Subtree>> linked;   ///< built by other tasks, in the order of cells
  BuildStats counts;                              ///< of this subtree alone, without linked ones

  [[nodiscard]] std::uint64_t bytes() const {
    return nodes.size() * sizeof(BuildNode) + references.size() * sizeof(std::uint32_t);
  }
};

/// Depth cap of a tree of n triangles: min(max_depth, 8 + 1.3 lg n).
[[nodiscard]] int depth_cap(int max_depth, std::size_t n);

/// What both builders decide alike for a cell of n references: the plane to split it, or none.
[[nodiscard]] SplitPlane choose_plane(const BuildContext& context, PlaneSearch& search, Runs runs,
                                      const SweepInput& input, int depth, int max_depth,
                                      bool parallel, BuildStats& counts);

struct Shares {
  std::uint64_t left_budget = 0, right_budget = 0;
  double left_share = 0.0;  ///< 0..1 of the parent's
};

/// What is left of a budget after a split of n into two parts goes to them in proportion to their
/// references, so that all cells of a level together never hold more than the whole build may.
[[nodiscard]] Shares share_out(std::uint64_t budget, std::uint64_t n, std::uint64_t n_left,
                               std::uint64_t n_right);

/// Builds a small cell on the calling thread.
[[nodiscard]] std::unique_ptr<Subtree> build_subtree(BuildContext& context, SubtreeInput input,
                                                     int max_depth);

/// Builds the cell of all triangles. After a stop the result is valid but useless.
[[nodiscard]] std::unique_ptr<Subtree> build_root(BuildContext& context, SubtreeInput input,
                                                  int max_depth);

}  // namespace raykiln::render
