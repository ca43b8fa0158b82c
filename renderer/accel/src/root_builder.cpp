#include <algorithm>
#include <cmath>

#include "reference_split.hpp"
#include "subtree_builder.hpp"

namespace raykiln::render {
namespace {

// Large cells one after the other, each by all threads: the work on a cell is cut at its runs, which
// depend on nothing but the cells above. Small cells wait until all large ones are done.
class RootBuilder {
 public:
  RootBuilder(BuildContext& context, int max_depth)
      : context_(context),
        search_(std::make_unique<PlaneSearch>(context)),
        max_depth_(max_depth),
        result_(std::make_unique<Subtree>()) {}

  std::unique_ptr<Subtree> build(SubtreeInput input) {
    live_ = bytes_of(input);
    note_live(0);
    const double levels = levels_above_tasks(input.size());
    const double all = std::max(1.0, std::log2(static_cast<double>(input.size() + 2)));
    const double top_share = input.share * levels / all;
    input.share -= top_share;
    result_->root = build_cell(std::move(input), top_share);
    search_.reset();  // its memory is as large as the root
    build_waiting();
    return std::move(result_);
  }

 private:
  static double levels_above_tasks(std::size_t n) {
    return n < kParallelMin ? 0.0
                            : std::log2(static_cast<double>(n) / (kParallelMin / 2.0));
  }
  static std::uint64_t bytes_of(const SubtreeInput& input) {
    return input.size() * sizeof(Reference);
  }

  // `top_share` of the build is what large cells from this one on are expected to take.
  std::uint32_t build_cell(SubtreeInput input, double top_share) {
    const std::size_t n = input.size();
    if (n < kParallelMin) {
      input.share += top_share;
      return link(std::move(input));
    }
    const SplitPlane plane = context_.stopped() ? SplitPlane{} : choose(input, n);
    if (plane.axis < 0 || context_.stopped()) return emit_leaf(input, top_share);
    const auto index = static_cast<std::uint32_t>(result_->nodes.size());
    result_->nodes.push_back({BuildNode::Kind::kInner, static_cast<std::uint8_t>(plane.axis),
                              plane.position, 0, 0});
    const double here = top_share / std::max(1.0, levels_above_tasks(n));
    const double below = top_share - here;
    auto [left, right] = split(std::move(input), plane, n);
    context_.finished(here);
    const std::size_t n_left = left.size();
    const std::size_t total = n_left + right.size();
    const double to_left =
        total == 0 ? 0.0 : below * static_cast<double>(n_left) / static_cast<double>(total);
    const std::uint32_t a = build_cell(std::move(left), to_left);
    const std::uint32_t b = build_cell(std::move(right), below - to_left);
    result_->nodes[index].a = a;
    result_->nodes[index].b = b;
    return index;
  }

  SplitPlane choose(const SubtreeInput& input, std::size_t n) {
    std::vector<std::span<const Reference>> runs;
    for (const Run& run : input.runs) runs.push_back(run.view());
    note_live(n * sizeof(BinCode));
    return choose_plane(context_, *search_, runs,
                        {input.cell, static_cast<std::uint32_t>(n), input.budget}, input.depth,
                        max_depth_, context_.concurrent, result_->counts);
  }

  std::array<SubtreeInput, 2> split(SubtreeInput input, const SplitPlane& plane, std::size_t n) {
    const ReferenceSplit cut(context_, input.cell, plane);
    const std::vector<std::span<Run>> groups = group(input.runs);
    std::array<SubtreeInput, 2> parts;
    parts[0].runs.resize(groups.size());
    parts[1].runs.resize(groups.size());
    const std::vector<std::size_t> given = sizes_of(groups);
    std::vector<std::uint64_t> clips(groups.size());
    context_.for_each(groups.size(), [&](std::size_t i) {
      if (!context_.stopped()) {
        clips[i] = split_group(cut, groups[i], parts[0].runs[i], parts[1].runs[i]);
      }
    });
    for (const std::uint64_t c : clips) result_->counts.clips += c;
    result_->counts.events_moved += 6 * std::uint64_t{n};
    parts[0].cell = cut.left_cell();
    parts[1].cell = cut.right_cell();
    const Shares shares = share_out(input.budget, n, parts[0].size(), parts[1].size());
    parts[0].budget = shares.left_budget;
    parts[1].budget = shares.right_budget;
    parts[0].share = input.share * shares.left_share;
    parts[1].share = input.share - parts[0].share;
    note_parts(given, parts);
    for (SubtreeInput& part : parts) {
      part.depth = input.depth + 1;
      std::erase_if(part.runs, [](const Run& run) { return run.size == 0; });
    }
    return parts;
  }

  static std::vector<std::size_t> sizes_of(std::span<const std::span<Run>> groups) {
    std::vector<std::size_t> sizes;
    for (const std::span<Run>& runs : groups) {
      sizes.push_back(0);
      for (const Run& run : runs) sizes.back() += run.size;
    }
    return sizes;
  }

  // A group stands beside its parts until it is cut: those before it are freed, those after it wait.
  void note_parts(std::span<const std::size_t> given, std::span<const SubtreeInput, 2> parts) {
    for (std::size_t i = 0; i < given.size(); ++i) {
      live_ += (parts[0].runs[i].size + parts[1].runs[i].size) * sizeof(Reference);
      note_live(0);
      live_ -= given[i] * sizeof(Reference);
    }
  }

  // Neighbouring runs that are small together are split as one, so their number falls with n.
  static std::vector<std::span<Run>> group(std::vector<Run>& runs) {
    std::vector<std::span<Run>> groups;
    std::size_t begin = 0;
    std::size_t size = 0;
    for (std::size_t i = 0; i < runs.size(); ++i) {
      size += runs[i].size;
      if (size < kRunSize && i + 1 < runs.size()) continue;
      groups.emplace_back(runs.data() + begin, i + 1 - begin);
      begin = i + 1;
      size = 0;
    }
    return groups;
  }

  // Frees the runs as it goes.
  static std::uint64_t split_group(const ReferenceSplit& cut, std::span<Run> runs, Run& left,
                                   Run& right) {
    ReferenceSplit::Sizes room{};
    for (const Run& run : runs) {
      const auto sizes = cut.count(run.view());
      room.left += sizes.left;
      room.right += sizes.right;
    }
    // One more: a reference is written to both sides and then counted on one.
    left.data = std::make_unique_for_overwrite<Reference[]>(room.left + 1);
    right.data = std::make_unique_for_overwrite<Reference[]>(room.right + 1);
    std::uint64_t clips = 0;
    for (Run& run : runs) {
      const auto sizes =
          cut.run(run.view(), left.data.get() + left.size, right.data.get() + right.size);
      left.size += sizes.left;
      right.size += sizes.right;
      clips += sizes.clips;
      run = {};
    }
    return clips;
  }

  std::uint32_t emit_leaf(const SubtreeInput& input, double top_share) {
    auto& references = result_->references;
    const auto first = static_cast<std::uint32_t>(references.size());
    for (const Run& run : input.runs) {
      for (const Reference& r : run.view()) references.push_back(r.triangle);
    }
    live_ -= bytes_of(input);
    result_->nodes.push_back({BuildNode::Kind::kLeaf, 0, 0.0F, first,
                              static_cast<std::uint32_t>(references.size()) - first});
    context_.finished(input.share + top_share);
    return static_cast<std::uint32_t>(result_->nodes.size() - 1);
  }

  std::uint32_t link(SubtreeInput input) {
    result_->nodes.push_back({BuildNode::Kind::kLink, 0, 0.0F,
                              static_cast<std::uint32_t>(waiting_.size()), 0});
    waiting_.push_back(std::move(input));
    return static_cast<std::uint32_t>(result_->nodes.size() - 1);
  }

  void build_waiting() {
    std::vector<std::uint64_t> bytes;
    for (const SubtreeInput& input : waiting_) bytes.push_back(bytes_of(input));
    result_->linked.resize(waiting_.size());
    context_.for_each(waiting_.size(), [&](std::size_t i) {
      result_->linked[i] = build_subtree(context_, std::move(waiting_[i]), max_depth_);
    });
    std::uint64_t built = 0;
    for (std::size_t i = 0; i < bytes.size(); ++i) {  // as one thread does it
      live_ -= bytes[i];
      built += result_->linked[i]->bytes();
      note_live(built + result_->linked[i]->counts.live_bytes_peak);
    }
  }

  void note_live(std::uint64_t more) {
    std::uint64_t& peak = result_->counts.live_bytes_peak;
    peak = std::max(peak, live_ + more);
  }

  BuildContext& context_;
  std::unique_ptr<PlaneSearch> search_;
  int max_depth_;
  std::unique_ptr<Subtree> result_;
  std::vector<SubtreeInput> waiting_;
  std::uint64_t live_ = 0;  ///< bytes of all references that wait
};

}  // namespace

std::unique_ptr<Subtree> build_root(BuildContext& context, SubtreeInput input, int max_depth) {
  return RootBuilder(context, max_depth).build(std::move(input));
}

}  // namespace raykiln::render
