#include <algorithm>
#include <cstdint>
#include <memory>
#include <stdexcept>

#include "build_context.hpp"
#include "raykiln/accel/kdtree.hpp"
#include "raykiln/accel/kdtree_data.hpp"
#include "root_events.hpp"
#include "subtree_builder.hpp"
#include "tree_layout.hpp"
#include "tree_pages.hpp"

namespace raykiln::render {
namespace {

void copy_mesh(const TriangleView& mesh, KdTree& tree) {
  tree.positions.assign(mesh.positions.begin(), mesh.positions.end());
  tree.triangles.assign(mesh.triangles.begin(), mesh.triangles.end());
  const bool all_opaque = std::all_of(mesh.opaque.begin(), mesh.opaque.end(),
                                      [](std::uint8_t flag) { return flag != 0; });
  if (all_opaque) return;
  tree.opaque_bits.assign((mesh.triangles.size() + 63) / 64, 0);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (mesh.opaque[i] != 0) tree.opaque_bits[i >> 6] |= std::uint64_t{1} << (i & 63U);
  }
}

template <typename T>
std::uint64_t size_in_bytes(const std::vector<T>& v) {
  return v.size() * sizeof(T);
}

void release_spare_memory(KdTree& tree) {
  tree.nodes.shrink_to_fit();
  tree.blocks8.shrink_to_fit();
  tree.blocks16.shrink_to_fit();
}

}  // namespace

std::shared_ptr<const KdTree> build_kdtree(const TriangleView& mesh, const BuildParams& params,
                                           TaskRunner& runner) {
  if (mesh.triangles.size() > kMaxEventId) throw std::length_error("kd-tree: over 2^30 triangles");
  if (!mesh.opaque.empty() && mesh.opaque.size() != mesh.triangles.size()) {
    throw std::invalid_argument("kd-tree: one opaque flag a triangle, or none");
  }
  BuildContext context(mesh, params, runner);
  RootInput root = make_root(context);
  if (context.stopped()) return nullptr;

  auto tree = std::make_shared<KdTree>();
  tree->box = root.subtree.cell;
  tree->params = context.params;
  tree->stats.triangles = mesh.triangles.size();
  tree->stats.dropped_degenerate = root.dropped_degenerate;
  tree->stats.keys_sorted_passes = root.sort_operations;
  const std::size_t n = root.subtree.ids.size();
  root.subtree.budget = static_cast<std::uint64_t>((context.params.max_duplication - 1.0) *
                                                   static_cast<double>(n));
  tree->stats.leaf_cost = context.params.k_i * static_cast<double>(n);
  const int cap = depth_cap(context.params.max_depth, n);
  const auto built = build_subtree(context, std::move(root.subtree), cap);
  if (context.stopped() || !lay_out(context, *built, *tree)) return nullptr;
  copy_mesh(mesh, *tree);
  release_spare_memory(*tree);
  tree->stats.bytes = size_in_bytes(tree->nodes) + size_in_bytes(tree->blocks8) +
                      size_in_bytes(tree->blocks16) + size_in_bytes(tree->opaque_bits);
  prefer_large_pages(*tree);
  runner.progress(1.0);
  return tree;
}

const BuildStats& build_stats(const KdTree& tree) { return tree.stats; }
Bounds3f bounds(const KdTree& tree) { return tree.box; }

}  // namespace raykiln::render
