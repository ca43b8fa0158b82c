#include <algorithm>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>

#include "build_context.hpp"
#include "raykiln/accel/build_limits.hpp"
#include "raykiln/accel/kdtree.hpp"
#include "raykiln/accel/kdtree_data.hpp"
#include "root_references.hpp"
#include "subtree_builder.hpp"
#include "tree_layout.hpp"
#include "tree_pages.hpp"

namespace raykiln::render {
namespace {

constexpr std::size_t kMaxTriangles = std::size_t{1} << 30;  // nodes keep 30 bits of an index

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

std::uint64_t mesh_bytes(const TriangleView& mesh) {
  return mesh.positions.size_bytes() + mesh.triangles.size_bytes();
}

// What a reference may take: it may stand in a cell and in the part that is split off, and end up
// alone in a leaf with a block, a node above it and both before they had their places.
std::uint64_t bytes_of_reference(const BuildParams& params) {
  const std::size_t block =
      params.leaf_width == 16 ? sizeof(LeafBlock<16>) : sizeof(LeafBlock<8>);
  return 2 * sizeof(Reference) + block + sizeof(std::uint32_t) +
         2 * (sizeof(KdNode) + sizeof(BuildNode));
}

void refuse_too_little(const TriangleView& mesh, const BuildParams& params,
                       const BuildLimits& limits) {
  const std::uint64_t least = least_bytes(mesh, params);
  if (limits.max_bytes == 0 || limits.max_bytes >= least) return;
  throw std::length_error("kd-tree: " + std::to_string(mesh.triangles.size()) +
                          " triangles may need " + std::to_string(least) +
                          " bytes, and the limit is " + std::to_string(limits.max_bytes));
}

}  // namespace

std::shared_ptr<const KdTree> build_kdtree(const TriangleView& mesh, const BuildParams& params,
                                           TaskRunner& runner) {
  return build_kdtree(mesh, params, runner, BuildLimits{});
}

std::shared_ptr<const KdTree> build_kdtree(const TriangleView& mesh, const BuildParams& params,
                                           TaskRunner& runner, const BuildLimits& limits) {
  if (mesh.triangles.size() > kMaxTriangles) throw std::length_error("kd-tree: over 2^30 triangles");
  if (!mesh.opaque.empty() && mesh.opaque.size() != mesh.triangles.size()) {
    throw std::invalid_argument("kd-tree: one opaque flag a triangle, or none");
  }
  BuildContext context(mesh, params, runner);
  refuse_too_little(mesh, context.params, limits);
  RootInput root = make_root(context);
  if (context.stopped()) return nullptr;

  auto tree = std::make_shared<KdTree>();
  tree->box = root.subtree.cell;
  tree->params = context.params;
  tree->stats.triangles = mesh.triangles.size();
  tree->stats.dropped_degenerate = root.dropped_degenerate;
  const std::size_t n = root.subtree.size();
  const double duplication = affordable_duplication(mesh, context.params, limits);
  root.subtree.budget = static_cast<std::uint64_t>((duplication - 1.0) * static_cast<double>(n));
  tree->stats.leaf_cost = context.params.k_i * static_cast<double>(n);
  const int cap = depth_cap(context.params.max_depth, n);
  auto built = build_root(context, std::move(root.subtree), cap);
  if (context.stopped() || !lay_out(context, *built, *tree)) return nullptr;
  built.reset();
  copy_mesh(mesh, *tree);
  tree->stats.bytes = size_in_bytes(tree->nodes) + size_in_bytes(tree->blocks8) +
                      size_in_bytes(tree->blocks16) + size_in_bytes(tree->opaque_bits);
  prefer_large_pages(*tree);
  runner.progress(1.0);
  return tree;
}

std::uint64_t least_bytes(const TriangleView& mesh, const BuildParams& params) {
  return mesh_bytes(mesh) + mesh.triangles.size() * bytes_of_reference(params);
}

double affordable_duplication(const TriangleView& mesh, const BuildParams& params, const BuildLimits& limits) {
  if (limits.max_bytes == 0 || mesh.triangles.empty()) return params.max_duplication;
  const std::uint64_t left = limits.max_bytes - std::min(limits.max_bytes, mesh_bytes(mesh));
  const double references = static_cast<double>(left) / static_cast<double>(bytes_of_reference(params));
  return std::clamp(references / static_cast<double>(mesh.triangles.size()), 1.0, params.max_duplication);
}

const BuildStats& build_stats(const KdTree& tree) { return tree.stats; }
Bounds3f bounds(const KdTree& tree) { return tree.box; }

}  // namespace raykiln::render
