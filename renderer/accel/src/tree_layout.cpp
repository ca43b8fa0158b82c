#include "tree_layout.hpp"

#include <algorithm>
#include <span>
#include <stdexcept>

#include "sah_sweep.hpp"
#include "tree_pages.hpp"

namespace raykiln::render {
namespace {

/// Places that the own nodes of a subtree take.
struct Extent {
  std::size_t nodes = 0, blocks = 0;
};

Extent extent_of(const Subtree& subtree, std::size_t width) {
  Extent extent;
  for (const BuildNode& node : subtree.nodes) {
    if (node.kind == BuildNode::Kind::kInner) extent.nodes += 2;
    if (node.kind == BuildNode::Kind::kLeaf) extent.blocks += (node.b + width - 1) / width;
  }
  return extent;
}

/// Where a node goes, and the cell that it stands for.
struct Place {
  std::uint32_t node = 0;  ///< index in the subtree
  std::uint32_t to = 0;    ///< index in the tree
  int depth = 0;
  Bounds3f cell;
};

/// A subtree that is laid out by a task of its own, from these places on.
struct Link {
  std::uint32_t subtree = 0;
  Place root;
  Extent begin;
};

template <int W>
void fill_block(const BuildContext& context, std::span<const std::uint32_t> ids,
                LeafBlock<W>& block) {
  for (std::size_t lane = 0; lane < W; ++lane) {
    const bool used = lane < ids.size();
    const auto corners = context.corners(used ? ids[lane] : ids[0]);
    for (std::size_t c = 0; c < 3; ++c) {
      const Vec3f& p = corners[used ? c : 0];
      for (std::size_t k = 0; k < 3; ++k) block.v[c][k][lane] = p[static_cast<int>(k)];
    }
    block.id[lane] = used ? ids[lane] : kNoHit;
  }
}

/// Depth first, left before right: so the places of a subtree are neighbours.
class SubtreeLayout {
 public:
  SubtreeLayout(BuildContext& context, KdTree& tree, double root_area, const Extent& begin)
      : context_(context), tree_(tree), root_area_(root_area), next_(begin) {}

  /// `extents` are those of the linked subtrees, which are left out and noted in `links`.
  void run(const Subtree& subtree, const Place& root, std::span<const Extent> extents) {
    pending_.push_back(root);
    for (std::size_t step = 0; !pending_.empty(); ++step) {
      if (step % 1024 == 0 && context_.stopped()) return;
      const Place place = pending_.back();
      pending_.pop_back();
      const BuildNode& node = subtree.nodes[place.node];
      switch (node.kind) {
        case BuildNode::Kind::kLink:
          links.push_back({node.a, place, next_});
          next_.nodes += extents[node.a].nodes;
          next_.blocks += extents[node.a].blocks;
          break;
        case BuildNode::Kind::kInner:
          place_inner(place, node);
          break;
        case BuildNode::Kind::kLeaf:
          place_leaf(place, std::span(subtree.references).subspan(node.a, node.b));
          break;
      }
    }
  }

  std::vector<Link> links;
  BuildStats stats;

 private:
  void place_inner(const Place& p, const BuildNode& node) {
    const auto pair = static_cast<std::uint32_t>(next_.nodes);
    next_.nodes += 2;
    tree_.nodes[p.to] = make_inner(node.axis, node.split, pair);
    Bounds3f left = p.cell;
    Bounds3f right = p.cell;
    left.hi[node.axis] = right.lo[node.axis] = node.split;
    pending_.push_back({node.b, pair + 1, p.depth + 1, right});
    pending_.push_back({node.a, pair, p.depth + 1, left});
    ++stats.inner_nodes;
    stats.sah_cost += tree_.params.k_t * visit_probability(p.cell);
  }

  void place_leaf(const Place& p, std::span<const std::uint32_t> ids) {
    tree_.nodes[p.to] = tree_.params.leaf_width == 16 ? fill_leaf(ids, tree_.blocks16)
                                                      : fill_leaf(ids, tree_.blocks8);
    ++stats.leaves;
    stats.empty_leaves += ids.empty() ? 1U : 0U;
    stats.references += ids.size();
    stats.depth = std::max(stats.depth, p.depth);
    stats.sah_cost +=
        tree_.params.k_i * static_cast<double>(ids.size()) * visit_probability(p.cell);
  }

  template <int W>
  KdNode fill_leaf(std::span<const std::uint32_t> ids, std::vector<LeafBlock<W>>& blocks) {
    const std::size_t first = next_.blocks;
    for (; !ids.empty(); ids = ids.subspan(std::min<std::size_t>(W, ids.size()))) {
      fill_block(context_, ids, blocks[next_.blocks++]);
    }
    const auto count = static_cast<std::uint32_t>(next_.blocks - first);
    return make_leaf(count, count == 0 ? 0 : static_cast<std::uint32_t>(first));
  }

  // Of a random line that meets the root's box to meet the cell.
  [[nodiscard]] double visit_probability(const Bounds3f& cell) const {
    return root_area_ > 0.0 ? surface_area(cell) / root_area_ : 1.0;
  }

  BuildContext& context_;
  KdTree& tree_;
  double root_area_;
  Extent next_;
  std::vector<Place> pending_;
};

void add_counts(const BuildStats& counts, BuildStats& stats) {
  stats.events_swept += counts.events_swept;
  stats.events_moved += counts.events_moved;
  stats.keys_sorted_passes += counts.keys_sorted_passes;
  stats.clips += counts.clips;
  stats.splits_over_budget += counts.splits_over_budget;
  stats.splits_over_depth += counts.splits_over_depth;
}

constexpr std::size_t kMaxIndices = std::size_t{1} << 30;  // nodes keep 30 bits of an index

void add_shape(const BuildStats& part, BuildStats& stats) {
  stats.inner_nodes += part.inner_nodes;
  stats.leaves += part.leaves;
  stats.empty_leaves += part.empty_leaves;
  stats.references += part.references;
  stats.depth = std::max(stats.depth, part.depth);
  stats.sah_cost += part.sah_cost;
}

}  // namespace

bool lay_out(BuildContext& context, Subtree& root, KdTree& tree) {
  const auto width = static_cast<std::size_t>(tree.params.leaf_width);
  std::vector<Extent> extents(root.linked.size());
  context.for_each(extents.size(),
                   [&](std::size_t i) { extents[i] = extent_of(*root.linked[i], width); });
  Extent all = extent_of(root, width);
  std::uint64_t built = root.bytes();
  add_counts(root.counts, tree.stats);
  for (std::size_t i = 0; i < extents.size(); ++i) {
    all.nodes += extents[i].nodes;
    all.blocks += extents[i].blocks;
    built += root.linked[i]->bytes();
    add_counts(root.linked[i]->counts, tree.stats);
  }
  if (2 + all.nodes > kMaxIndices || all.blocks > kMaxIndices) {
    throw std::length_error("kd-tree: over 2^30 nodes or blocks");
  }
  resize_in_large_pages(tree.nodes, 2 + all.nodes);  // empty leaves
  if (tree.params.leaf_width == 16) {
    resize_in_large_pages(tree.blocks16, all.blocks);
  } else {
    resize_in_large_pages(tree.blocks8, all.blocks);
  }

  const double root_area = surface_area(tree.box);
  SubtreeLayout top(context, tree, root_area, {2, 0});
  top.run(root, {root.root, 0, 0, tree.box}, extents);
  add_shape(top.stats, tree.stats);
  std::vector<BuildStats> parts(top.links.size());
  context.for_each(parts.size(), [&](std::size_t i) {
    const Link& link = top.links[i];
    auto& subtree = root.linked[link.subtree];
    SubtreeLayout layout(context, tree, root_area, link.begin);
    layout.run(*subtree, {subtree->root, link.root.to, link.root.depth, link.root.cell}, {});
    parts[i] = layout.stats;
    subtree.reset();
  });
  for (const BuildStats& part : parts) add_shape(part, tree.stats);
  tree.stats.nodes = tree.stats.inner_nodes + tree.stats.leaves;
  const std::uint64_t laid_out = tree.nodes.size() * sizeof(KdNode) +
                                 tree.blocks8.size() * sizeof(LeafBlock<8>) +
                                 tree.blocks16.size() * sizeof(LeafBlock<16>);
  tree.stats.live_bytes_peak = std::max(root.counts.live_bytes_peak, built + laid_out);
  return !context.stopped();
}

}  // namespace raykiln::render
