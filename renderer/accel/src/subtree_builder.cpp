#include "subtree_builder.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "raykiln/accel/kdtree_data.hpp"

namespace raykiln::render {
namespace {

class SubtreeBuilder {
 public:
  SubtreeBuilder(BuildContext& context, SubtreeInput& input, int max_depth)
      : context_(context),
        mesh_ids_(std::move(input.ids)),
        partition_(context, mesh_ids_),
        max_depth_(max_depth),
        result_(std::make_unique<Subtree>()) {
    stacks_.events = std::move(input.events);
    stacks_.ids.resize(mesh_ids_.size());
    for (std::size_t i = 0; i < mesh_ids_.size(); ++i) {
      stacks_.ids[i] = static_cast<std::uint32_t>(i);
    }
    root_ = {input.cell, {}, input.depth, input.budget, input.share};
    note_live(0);
  }

  std::unique_ptr<Subtree> build() {
    result_->root = build_top(root_);
    return std::move(result_);
  }

 private:
  struct Cell {
    Bounds3f box;
    StackMark begin;
    int depth = 0;
    std::uint64_t budget = 0;
    double share = 0.0;
  };

  // Builds the cell on top of the stacks and takes it off.
  std::uint32_t build_top(const Cell& cell) {
    const std::size_t n = stacks_.ids.size() - cell.begin.ids;
    const SplitPlane plane = context_.stopped() ? SplitPlane{} : choose(cell, n);
    if (plane.axis < 0 || context_.stopped()) return emit_leaf(cell);

    auto& nodes = result_->nodes;
    const auto index = static_cast<std::uint32_t>(nodes.size());
    nodes.push_back({BuildNode::Kind::kInner, static_cast<std::uint8_t>(plane.axis),
                     plane.position, 0, 0});
    Cell left = cell;
    Cell right = cell;
    left.box.hi[plane.axis] = right.box.lo[plane.axis] = plane.position;
    left.depth = right.depth = cell.depth + 1;
    right.begin = partition_.split(stacks_, cell.begin, cell.box, plane, result_->counts);
    note_live(0);
    share_out(n, cell, left, right);

    std::array<std::uint32_t, 2> children{};
    if (context_.concurrent && n >= kParallelMin) {
      children = build_as_tasks(left, right);
    } else {
      children[1] = build_top(right);
      children[0] = build_top(left);
    }
    nodes[index].a = children[0];
    nodes[index].b = children[1];
    return index;
  }

  // What is left of the budget goes to the children in proportion to their references, so that
  // all cells of a level together never hold more than the whole build may.
  void share_out(std::size_t n, const Cell& cell, Cell& left, Cell& right) const {
    const std::uint64_t n_left = right.begin.ids - left.begin.ids;
    const std::uint64_t n_right = stacks_.ids.size() - right.begin.ids;
    const std::uint64_t total = n_left + n_right;
    const std::uint64_t added = total > n ? total - n : 0;
    const std::uint64_t rest = cell.budget - std::min(cell.budget, added);
    left.budget = total == 0 ? 0 : rest / total * n_left + rest % total * n_left / total;
    right.budget = rest - left.budget;
    left.share = total == 0 ? cell.share
                            : cell.share * static_cast<double>(n_left) / static_cast<double>(total);
    right.share = cell.share - left.share;
  }

  [[nodiscard]] std::span<const EventKey> events_of(const Cell& cell, std::size_t axis) const {
    return std::span(stacks_.events[axis]).subspan(cell.begin.events[axis]);
  }

  SplitPlane choose(const Cell& cell, std::size_t n) {
    const double leaf_cost = context_.params.k_i * static_cast<double>(n);
    if (n == 0 || leaf_cost <= context_.params.k_t * context_.params.empty_factor) return {};
    const SweepInput input{cell.box, static_cast<std::uint32_t>(n), cell.budget};
    std::array<SweepResult, 3> results;
    context_.for_each_axis(n >= kParallelMin, [&](int axis) {
      const auto a = static_cast<std::size_t>(axis);
      results[a] = sweep_axis(events_of(cell, a), axis, input, context_);
    });
    SplitPlane best;
    double unaffordable = leaf_cost;
    for (std::size_t a = 0; a < 3; ++a) {
      result_->counts.events_swept += events_of(cell, a).size();
      if (results[a].best.cost < best.cost) best = results[a].best;
      unaffordable = std::min(unaffordable, results[a].unaffordable);
    }
    const bool useful = best.cost < leaf_cost;
    if (unaffordable < std::min(best.cost, leaf_cost)) result_->counts.budget_reached = true;
    if (useful && cell.depth >= max_depth_) result_->counts.budget_reached = true;
    return useful && cell.depth < max_depth_ ? best : SplitPlane{};
  }

  std::uint32_t emit_leaf(const Cell& cell) {
    auto& references = result_->references;
    const auto first = static_cast<std::uint32_t>(references.size());
    for (std::size_t i = cell.begin.ids; i < stacks_.ids.size(); ++i) {
      references.push_back(mesh_ids_[stacks_.ids[i]]);
    }
    cut_to(stacks_, cell.begin);
    result_->nodes.push_back({BuildNode::Kind::kLeaf, 0, 0.0F, first,
                              static_cast<std::uint32_t>(references.size()) - first});
    context_.finished(cell.share);
    return static_cast<std::uint32_t>(result_->nodes.size() - 1);
  }

  [[nodiscard]] static std::uint64_t bytes_from(const StackMark& begin, const EventStacks& stacks) {
    std::uint64_t bytes = (stacks.ids.size() - begin.ids) * sizeof(std::uint32_t);
    for (std::size_t a = 0; a < 3; ++a) {
      bytes += (stacks.events[a].size() - begin.events[a]) * sizeof(EventKey);
    }
    return bytes;
  }

  // `more` bytes stand beside what is on the stacks.
  void note_live(std::uint64_t more) {
    std::uint64_t& peak = result_->counts.live_bytes_peak;
    peak = std::max(peak, bytes_from({}, stacks_) + more);
  }

  std::array<std::uint32_t, 2> build_as_tasks(const Cell& left, const Cell& right) {
    std::array<SubtreeInput, 2> inputs;
    inputs[1] = take_top(right);
    const std::uint64_t left_bytes = bytes_from(left.begin, stacks_);
    inputs[0] = take_top(left);
    const std::uint64_t below = bytes_from({}, stacks_);
    if (stacks_.ids.empty()) stacks_ = {};  // gives the memory back while the tasks run
    std::array<std::unique_ptr<Subtree>, 2> built;
    const std::array<std::function<void()>, 2> tasks{
        [&] { built[0] = build_subtree(context_, std::move(inputs[0]), max_depth_); },
        [&] { built[1] = build_subtree(context_, std::move(inputs[1]), max_depth_); }};
    context_.runner.run(tasks);
    // As one thread does it: the right one first, while the left one waits.
    std::uint64_t& peak = result_->counts.live_bytes_peak;
    peak = std::max({peak, below + left_bytes + built[1]->counts.live_bytes_peak,
                     below + built[0]->counts.live_bytes_peak});
    return {link(std::move(built[0])), link(std::move(built[1]))};
  }

  std::uint32_t link(std::unique_ptr<Subtree> subtree) {
    result_->nodes.push_back({BuildNode::Kind::kLink, 0, 0.0F,
                              static_cast<std::uint32_t>(result_->linked.size()), 0});
    result_->linked.push_back(std::move(subtree));
    return static_cast<std::uint32_t>(result_->nodes.size() - 1);
  }

  // Takes the top cell off the stacks with ids of its own.
  SubtreeInput take_top(const Cell& cell) {
    SubtreeInput input{cell.box, cell.depth, cell.budget, cell.share, {}, {}};
    if (new_ids_.size() < mesh_ids_.size()) new_ids_.resize(mesh_ids_.size());
    input.ids.reserve(stacks_.ids.size() - cell.begin.ids);
    for (std::size_t i = cell.begin.ids; i < stacks_.ids.size(); ++i) {
      new_ids_[stacks_.ids[i]] = static_cast<std::uint32_t>(input.ids.size());
      input.ids.push_back(mesh_ids_[stacks_.ids[i]]);
    }
    for (std::size_t a = 0; a < 3; ++a) {
      const auto events = events_of(cell, a);
      input.events[a].assign(events.begin(), events.end());
      for (EventKey& key : input.events[a]) key = with_event_id(key, new_ids_[event_id(key)]);
    }
    cut_to(stacks_, cell.begin);
    return input;
  }

  BuildContext& context_;
  std::vector<std::uint32_t> mesh_ids_;
  EventPartition partition_;
  int max_depth_;
  std::unique_ptr<Subtree> result_;
  EventStacks stacks_;
  std::vector<std::uint32_t> new_ids_;
  Cell root_;
};

}  // namespace

int depth_cap(int max_depth, std::size_t n) {
  if (n == 0) return 0;
  const double by_count = 8.0 + 1.3 * std::log2(static_cast<double>(n));
  return std::min({max_depth, static_cast<int>(by_count), kMaxKdDepth});
}

std::unique_ptr<Subtree> build_subtree(BuildContext& context, SubtreeInput input, int max_depth) {
  return SubtreeBuilder(context, input, max_depth).build();
}

}  // namespace raykiln::render
