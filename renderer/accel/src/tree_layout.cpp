#include "tree_layout.hpp"

#include <algorithm>
#include <span>

#include "sah_sweep.hpp"

namespace raykiln::render {
namespace {

// A node that has a place but no content yet.
struct Pending {
  const Subtree* subtree;
  std::uint32_t node;
  std::uint32_t place;
  int depth;
  Bounds3f cell;
};

template <int W>
void fill_lane(LeafBlock<W>& block, std::size_t lane, const std::array<Vec3f, 3>& corners,
               std::uint32_t id) {
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t k = 0; k < 3; ++k) {
      block.v[c][k][lane] = corners[c][static_cast<int>(k)];
    }
  }
  block.id[lane] = id;
}

template <int W>
KdNode append_blocks(const BuildContext& context, std::span<const std::uint32_t> ids,
                     std::vector<LeafBlock<W>>& blocks) {
  const auto first = static_cast<std::uint32_t>(blocks.size());
  for (std::size_t i = 0; i < ids.size(); i += W) {
    auto& block = blocks.emplace_back();
    for (std::size_t lane = 0; lane < W; ++lane) {
      if (i + lane < ids.size()) {
        fill_lane(block, lane, context.corners(ids[i + lane]), ids[i + lane]);
      } else {
        const Vec3f point = context.corners(ids[i])[0];
        fill_lane(block, lane, {point, point, point}, kNoHit);
      }
    }
  }
  const auto count = static_cast<std::uint32_t>(blocks.size()) - first;
  return make_leaf(count, count == 0 ? 0 : first);
}

class Layout {
 public:
  Layout(BuildContext& context, KdTree& tree) : context_(context), tree_(tree) {}

  bool run(const Subtree& root) {
    tree_.nodes.assign(2, make_leaf(0, 0));
    root_area_ = surface_area(tree_.box);
    pending_.push_back({&root, root.root, 0, 0, tree_.box});
    for (std::size_t step = 0; !pending_.empty(); ++step) {
      if (step % 1024 == 0 && context_.stopped()) return false;
      const Pending next = pending_.back();
      pending_.pop_back();
      place(next);
    }
    tree_.stats.nodes = tree_.stats.inner_nodes + tree_.stats.leaves;
    return true;
  }

 private:
  void place(const Pending& p) {
    const BuildNode& node = p.subtree->nodes[p.node];
    switch (node.kind) {
      case BuildNode::Kind::kLink: {
        const Subtree& linked = *p.subtree->linked[node.a];
        add_counts(linked.counts);
        pending_.push_back({&linked, linked.root, p.place, p.depth, p.cell});
        break;
      }
      case BuildNode::Kind::kInner:
        place_inner(p, node);
        break;
      case BuildNode::Kind::kLeaf:
        place_leaf(p, std::span(p.subtree->references).subspan(node.a, node.b));
        break;
    }
  }

  void place_inner(const Pending& p, const BuildNode& node) {
    const auto pair = static_cast<std::uint32_t>(tree_.nodes.size());
    tree_.nodes.resize(tree_.nodes.size() + 2);
    tree_.nodes[p.place] = make_inner(node.axis, node.split, pair);
    Bounds3f left = p.cell;
    Bounds3f right = p.cell;
    left.hi[node.axis] = right.lo[node.axis] = node.split;
    pending_.push_back({p.subtree, node.b, pair + 1, p.depth + 1, right});
    pending_.push_back({p.subtree, node.a, pair, p.depth + 1, left});
    ++tree_.stats.inner_nodes;
    tree_.stats.sah_cost += tree_.params.k_t * visit_probability(p.cell);
  }

  void place_leaf(const Pending& p, std::span<const std::uint32_t> ids) {
    tree_.nodes[p.place] = tree_.params.leaf_width == 16
                               ? append_blocks(context_, ids, tree_.blocks16)
                               : append_blocks(context_, ids, tree_.blocks8);
    auto& stats = tree_.stats;
    ++stats.leaves;
    stats.empty_leaves += ids.empty() ? 1U : 0U;
    stats.references += ids.size();
    stats.depth = std::max(stats.depth, p.depth);
    stats.sah_cost +=
        tree_.params.k_i * static_cast<double>(ids.size()) * visit_probability(p.cell);
  }

  // Of a random line that meets the root's box to meet the cell.
  [[nodiscard]] double visit_probability(const Bounds3f& cell) const {
    return root_area_ > 0.0 ? surface_area(cell) / root_area_ : 1.0;
  }

  void add_counts(const BuildStats& counts) {
    auto& stats = tree_.stats;
    stats.events_swept += counts.events_swept;
    stats.events_moved += counts.events_moved;
    stats.keys_sorted_passes += counts.keys_sorted_passes;
    stats.clips += counts.clips;
    stats.budget_reached = stats.budget_reached || counts.budget_reached;
  }

  BuildContext& context_;
  KdTree& tree_;
  double root_area_ = 0.0;
  std::vector<Pending> pending_;
};

}  // namespace

bool lay_out(BuildContext& context, const Subtree& root, KdTree& tree) {
  const BuildStats& counts = root.counts;
  tree.stats.events_swept += counts.events_swept;
  tree.stats.events_moved += counts.events_moved;
  tree.stats.keys_sorted_passes += counts.keys_sorted_passes;
  tree.stats.clips += counts.clips;
  tree.stats.budget_reached = counts.budget_reached;
  tree.stats.live_bytes_peak = counts.live_bytes_peak;  // holds that of linked subtrees
  return Layout(context, tree).run(root);
}

}  // namespace raykiln::render
