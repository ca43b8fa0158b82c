#include "subtree_builder.hpp"

#include <algorithm>
#include <cmath>

#include "raykiln/accel/kdtree_data.hpp"
#include "reference_split.hpp"

namespace raykiln::render {
namespace {

// References on top of each other; memory that is not cleared before it is written.
class ReferenceStack {
 public:
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] Reference* from(std::size_t begin) { return data_.get() + begin; }
  void set_size(std::size_t size) { size_ = size; }

  /// Room for `n` more on top; may move all.
  Reference* room(std::size_t n) {
    if (size_ + n > capacity_) {
      capacity_ = std::max(size_ + n, capacity_ + capacity_ / 2);
      auto larger = std::make_unique_for_overwrite<Reference[]>(capacity_);
      std::copy_n(data_.get(), size_, larger.get());
      data_ = std::move(larger);
    }
    return data_.get() + size_;
  }

 private:
  std::unique_ptr<Reference[]> data_;
  std::size_t size_ = 0, capacity_ = 0;
};

// The references of the cell in work lie on top of one of two stacks, those of the cells that wait
// below. A split leaves the left part where it is and puts the right one on the other stack.
class SubtreeBuilder {
 public:
  SubtreeBuilder(BuildContext& context, SubtreeInput input, int max_depth)
      : context_(context),
        stop_(context),
        search_(context),
        max_depth_(max_depth),
        result_(std::make_unique<Subtree>()) {
    Reference* to = stacks_[0].room(input.size() + input.size() / 4);
    stacks_[0].set_size(input.size());
    for (Run& run : input.runs) {
      to = std::copy_n(run.data.get(), run.size, to);
      run = {};
    }
    root_ = {input.cell, 0, 0, input.depth, input.budget, input.share};
    note_live();
  }

  std::unique_ptr<Subtree> build() {
    result_->root = build_top(root_);
    return std::move(result_);
  }

 private:
  struct Cell {
    Bounds3f box;
    std::size_t on = 0;  ///< which stack
    std::size_t begin = 0;
    int depth = 0;
    std::uint64_t budget = 0;
    double share = 0.0;
  };

  // Builds the cell on top of its stack and takes it off.
  std::uint32_t build_top(const Cell& cell) {
    const std::size_t n = stacks_[cell.on].size() - cell.begin;
    const SplitPlane plane = stop_.stopped_after(n + 16) ? SplitPlane{} : choose(cell, n);
    if (plane.axis < 0) return emit_leaf(cell, n);

    auto& nodes = result_->nodes;
    const auto index = static_cast<std::uint32_t>(nodes.size());
    nodes.push_back({BuildNode::Kind::kInner, static_cast<std::uint8_t>(plane.axis),
                     plane.position, 0, 0});
    Cell left = cell;
    Cell right = cell;
    left.box.hi[plane.axis] = right.box.lo[plane.axis] = plane.position;
    left.depth = right.depth = cell.depth + 1;
    right.on = 1 - cell.on;
    right.begin = stacks_[right.on].size();
    const ReferenceSplit::Sizes sizes = split_top(cell, plane, n);
    const Shares shares = share_out(cell.budget, n, sizes.left, sizes.right);
    left.budget = shares.left_budget;
    right.budget = shares.right_budget;
    left.share = cell.share * shares.left_share;
    right.share = cell.share - left.share;

    const std::uint32_t b = build_top(right);
    const std::uint32_t a = build_top(left);
    result_->nodes[index].a = a;
    result_->nodes[index].b = b;
    return index;
  }

  SplitPlane choose(const Cell& cell, std::size_t n) {
    const std::span<const Reference> all(stacks_[cell.on].from(cell.begin), n);
    return choose_plane(context_, search_, Runs(&all, 1),
                        {cell.box, static_cast<std::uint32_t>(n), cell.budget}, cell.depth,
                        max_depth_, false, result_->counts);
  }

  ReferenceSplit::Sizes split_top(const Cell& cell, const SplitPlane& plane, std::size_t n) {
    ReferenceStack& here = stacks_[cell.on];
    ReferenceStack& other = stacks_[1 - cell.on];
    Reference* const begin = here.from(cell.begin);
    const auto sizes =
        ReferenceSplit(context_, cell.box, plane).run({begin, n}, begin, other.room(n + 1));
    here.set_size(cell.begin + sizes.left);
    other.set_size(other.size() + sizes.right);
    result_->counts.clips += sizes.clips;
    result_->counts.events_moved += 6 * (n + sizes.right);
    note_live();
    return sizes;
  }

  std::uint32_t emit_leaf(const Cell& cell, std::size_t n) {
    auto& references = result_->references;
    const std::size_t first = references.size();
    references.resize(first + n);
    const Reference* const from = stacks_[cell.on].from(cell.begin);
    for (std::size_t i = 0; i < n; ++i) references[first + i] = from[i].triangle;
    stacks_[cell.on].set_size(cell.begin);
    result_->nodes.push_back({BuildNode::Kind::kLeaf, 0, 0.0F, static_cast<std::uint32_t>(first),
                              static_cast<std::uint32_t>(n)});
    unreported_ += cell.share;
    if (unreported_ > 1e-3 || stacks_[0].size() + stacks_[1].size() == 0) {
      context_.finished(unreported_);
      unreported_ = 0.0;
    }
    return static_cast<std::uint32_t>(result_->nodes.size() - 1);
  }

  void note_live() {
    std::uint64_t& peak = result_->counts.live_bytes_peak;
    peak = std::max<std::uint64_t>(peak, (stacks_[0].size() + stacks_[1].size()) * sizeof(Reference));
  }

  BuildContext& context_;
  StopGauge stop_;
  PlaneSearch search_;
  int max_depth_;
  std::unique_ptr<Subtree> result_;
  std::array<ReferenceStack, 2> stacks_;
  double unreported_ = 0.0;
  Cell root_;
};

}  // namespace

int depth_cap(int max_depth, std::size_t n) {
  if (n == 0) return 0;
  const double by_count = 8.0 + 1.3 * std::log2(static_cast<double>(n));
  return std::min({max_depth, static_cast<int>(by_count), kMaxKdDepth});
}

SplitPlane choose_plane(const BuildContext& context, PlaneSearch& search, Runs runs,
                        const SweepInput& input, int depth, int max_depth, bool parallel,
                        BuildStats& counts) {
  const BuildParams& params = context.params;
  const double leaf_cost = params.k_i * static_cast<double>(input.n);
  if (input.n == 0 || leaf_cost <= params.k_t * params.empty_factor) return {};
  const SweepResult found = search.find(runs, input, leaf_cost, parallel, counts);
  const bool useful = found.best.cost < leaf_cost;
  if (found.unaffordable < std::min(found.best.cost, leaf_cost)) ++counts.splits_over_budget;
  if (useful && depth >= max_depth) ++counts.splits_over_depth;
  return useful && depth < max_depth ? found.best : SplitPlane{};
}

Shares share_out(std::uint64_t budget, std::uint64_t n, std::uint64_t n_left,
                 std::uint64_t n_right) {
  const std::uint64_t total = n_left + n_right;
  if (total == 0) return {0, budget, 1.0};
  const std::uint64_t added = total > n ? total - n : 0;
  const std::uint64_t rest = budget - std::min(budget, added);
  Shares shares;
  shares.left_budget = rest / total * n_left + rest % total * n_left / total;
  shares.right_budget = rest - shares.left_budget;
  shares.left_share = static_cast<double>(n_left) / static_cast<double>(total);
  return shares;
}

std::unique_ptr<Subtree> build_subtree(BuildContext& context, SubtreeInput input, int max_depth) {
  return SubtreeBuilder(context, std::move(input), max_depth).build();
}

}  // namespace raykiln::render
