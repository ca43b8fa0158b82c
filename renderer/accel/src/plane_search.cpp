#include "plane_search.hpp"

#include <algorithm>
#include <limits>

#include "key_sort.hpp"

namespace raykiln::render {
namespace {

// Bins pay when they are fewer than events by far; the share of events that survive falls like
// the root of their number.
std::size_t bin_count(std::uint32_t n) {
  if (n < 64) return 16;
  if (n < 1024) return 32;
  return n < 8192 ? 64 : kMaxBins;
}

// Costs are sums and products of positive doubles, a few roundings each.
constexpr double kRoundingSlack = 1e-9;

}  // namespace

SweepResult PlaneSearch::find(Runs runs, const SweepInput& input, double leaf_cost, bool parallel,
                              BuildStats& counts) {
  const BuildParams& params = context_.params;
  Choosers choosers{PlaneChooser(0, input, params), PlaneChooser(1, input, params),
                    PlaneChooser(2, input, params)};
  if (runs.size() == 1 && input.n <= kCountingMax) {
    consider_by_counting(runs[0], input, leaf_cost, params, choosers, counts);
  } else {
    const BinGrid grid(input.cell, bin_count(input.n));
    count_bins(runs, grid, parallel);
    counts.events_swept += 6 * std::uint64_t{input.n};
    choose_segments(grid, input, leaf_cost, choosers);
    look_into_segments(runs, grid, input, leaf_cost, parallel, choosers, counts);
  }
  SweepResult result;
  for (const PlaneChooser& chooser : choosers) {
    const SweepResult& found = chooser.result();
    if (found.best.cost < result.best.cost) result.best = found.best;
    result.unaffordable = std::min(result.unaffordable, found.unaffordable);
  }
  return result;
}

void PlaneSearch::count_bins(Runs runs, const BinGrid& grid, bool parallel) {
  bins_.clear(grid.count());
  if (!parallel) {
    if (runs.size() == 1 && codes_.size() < runs[0].size() + 1) codes_.resize(runs[0].size() + 1);
    for (const auto run : runs) {
      if (looks_for_stop(run.size())) return;
      bins_.count(grid, run, runs.size() == 1 ? codes_.data() : nullptr);
    }
    return;
  }
  run_bins_.resize(runs.size());
  context_.for_each(runs.size(), [&](std::size_t i) {
    run_bins_[i].clear(grid.count());
    if (!context_.stopped()) run_bins_[i].count(grid, runs[i], nullptr);
  });
  for (const BinCounts& counted : run_bins_) bins_.add(counted, grid.count());
}

// What bounds the planes of a bin: at least the triangles that begin before it are on the left and
// at most those that do not end before it on the right, and the cost is linear between its edges.
double PlaneSearch::bound_axis(std::size_t axis, const BinGrid& grid, const SweepInput& input,
                               const CellCost& cost) {
  const BinCounts::Row& starts = bins_.starts[axis];
  const BinCounts::Row& ends = bins_.ends[axis];
  const std::size_t bins = grid.count();
  BinBounds& b = bounds_[axis];
  b.n_left[0] = b.n_gone[0] = 0;
  for (std::size_t i = 0; i <= bins; ++i) {
    b.n_left[i + 1] = b.n_left[i] + starts[i];
    b.n_gone[i + 1] = b.n_gone[i] + ends[i];
  }
  const CellCost::Line line = cost.line();
  std::array<double, kMaxBins + 1> left, right;  // tests weighed by area, at the edges
  for (std::size_t i = 0; i <= bins; ++i) {
    const double from_lo = grid.edge(axis, i);
    left[i] = line.cap + line.girth * from_lo;
    right[i] = line.cap + line.girth * (line.width - from_lo);
  }
  // How much the cost can change within the uncertainty of an edge.
  const double slack = line.girth * grid.edge_slack(axis) * 2.0 * input.n;
  double threshold = std::numeric_limits<double>::infinity();
  const std::uint64_t affordable = input.n + input.budget;
  for (std::size_t i = 1; i <= bins; ++i) {
    const std::uint32_t right_most = input.n - b.n_gone[i];
    const double nl = b.n_left[i], nl_most = b.n_left[i + 1];
    const double nr = input.n - b.n_gone[i + 1], nr_most = right_most;
    const double least = std::min(left[i - 1] * nl + right[i - 1] * nr, left[i] * nl + right[i] * nr);
    const double most = std::max(left[i - 1] * nl_most + right[i - 1] * nr_most,
                                 left[i] * nl_most + right[i] * nr_most);
    b.least[i] = line.k_t + (least - slack);
    const bool counts = (starts[i] | ends[i]) != 0 &&
                        std::uint64_t{b.n_left[i + 1]} + right_most <= affordable;
    if (counts && most < threshold) threshold = most;
  }
  return line.k_t + (threshold + slack);
}

void PlaneSearch::choose_segments(const BinGrid& grid, const SweepInput& input, double leaf_cost,
                                  const Choosers& choosers) {
  segments_.clear();
  double threshold = leaf_cost;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double best_at_most = bound_axis(axis, grid, input, choosers[axis].cost());
    if (best_at_most < threshold) threshold = best_at_most;
  }
  threshold *= 1.0 + kRoundingSlack;
  const double factor = context_.params.empty_factor * (1.0 - kRoundingSlack);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const BinBounds& b = bounds_[axis];
    for (std::size_t i = 1; i <= grid.count(); ++i) {
      if (b.least[i] * factor > threshold) continue;
      if ((bins_.starts[axis][i] | bins_.ends[axis][i]) == 0) continue;
      const bool may_be_empty = b.n_left[i] == 0 || b.n_gone[i + 1] == input.n;
      const double least = b.least[i] * (may_be_empty ? factor : 1.0 - kRoundingSlack);
      if (least > threshold) continue;
      segments_.push_back({axis, i, least, b.n_left[i], b.n_gone[i], 0, 0});
    }
  }
}

// The most promising bin first: its best plane rules out most of the others before they are gathered.
void PlaneSearch::look_into_segments(Runs runs, const BinGrid& grid, const SweepInput& input,
                                     double leaf_cost, bool parallel, Choosers& choosers,
                                     BuildStats& counts) {
  if (segments_.empty() || looks_for_stop(input.n)) return;
  const auto first = std::min_element(
      segments_.begin(), segments_.end(),
      [](const Segment& a, const Segment& b) { return a.least < b.least; });
  first_.assign(1, *first);
  segments_.erase(first);
  const double least = look_into(first_, runs, grid, input, leaf_cost, parallel, choosers, counts);
  std::erase_if(segments_, [&](const Segment& s) { return s.least > least; });
  if (segments_.empty() || looks_for_stop(input.n)) return;
  (void)look_into(segments_, runs, grid, input, least, parallel, choosers, counts);
}

double PlaneSearch::look_into(Segments& chosen, Runs runs, const BinGrid& grid,
                              const SweepInput& input, double least, bool parallel,
                              Choosers& choosers, BuildStats& counts) {
  place(chosen, grid.count(), runs.size());
  for (std::size_t a = 0; a < 3; ++a) {
    if ((wanted_.axes >> (8 * a) & 0xFF) != 0) counts.events_swept += 2 * std::uint64_t{input.n};
  }
  gather(chosen, runs, grid, parallel);
  for (const Segment& s : chosen) {
    if (s.least > least) continue;
    const std::span<EventKey> keys = std::span(keys_).subspan(s.begin, s.end - s.begin);
    if (looks_for_stop(keys.size())) return least;
    counts.keys_sorted_passes += sort_keys(keys, kEventIdBits, sort_scratch_, &context_);
    counts.events_swept += keys.size();
    sweep(keys, input, static_cast<int>(s.axis), s.n_left, s.n_gone, choosers[s.axis]);
    least = std::min(least, choosers[s.axis].result().best.cost);
  }
  return least;
}

// Room for the keys of the chosen bins, and one more a run for what is not wanted.
void PlaneSearch::place(Segments& chosen, std::size_t bins, std::size_t runs) {
  wanted_ = {};
  for (auto& row : segment_of_) {
    std::fill_n(row.begin(), bins + 2, static_cast<std::uint32_t>(chosen.size()));
  }
  std::size_t keys = 0;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    Segment& s = chosen[i];
    segment_of_[s.axis][s.bin] = static_cast<std::uint32_t>(i);
    wanted_.add(s.axis, s.bin);
    s.begin = s.end = keys;
    keys += bins_.starts[s.axis][s.bin] + bins_.ends[s.axis][s.bin];
  }
  if (keys_.size() < keys + runs) keys_.resize(keys + runs);
  waste_ = keys;
}

void PlaneSearch::gather(Segments& chosen, Runs runs, const BinGrid& grid, bool parallel) {
  Cursors cursors(chosen.size() + 1);
  for (std::size_t i = 0; i < chosen.size(); ++i) cursors[i] = chosen[i].begin;
  cursors.back() = waste_;
  if (!parallel) {
    const BinCode* const codes = runs.size() == 1 ? codes_.data() : nullptr;
    for (const auto run : runs) {
      if (looks_for_stop(run.size())) break;
      gather_run(run, codes, grid, cursors);
    }
    for (std::size_t i = 0; i < chosen.size(); ++i) chosen[i].end = cursors[i];
    return;
  }
  std::vector<Cursors> begin_of(runs.size()), end_of(runs.size());
  for (std::size_t r = 0; r < runs.size(); ++r) {
    begin_of[r] = end_of[r] = cursors;
    const BinCounts& bins = run_bins_[r];
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      const Segment& s = chosen[i];
      cursors[i] += bins.starts[s.axis][s.bin] + bins.ends[s.axis][s.bin];
    }
    ++cursors.back();
  }
  context_.for_each(runs.size(), [&](std::size_t r) {
    if (!context_.stopped()) gather_run(runs[r], nullptr, grid, end_of[r]);
  });
  for (std::size_t i = 0; i < chosen.size(); ++i) {  // planar extents gave one key, not two
    auto end = keys_.begin() + static_cast<std::ptrdiff_t>(chosen[i].begin);
    for (std::size_t r = 0; r < runs.size(); ++r) {
      end = std::copy(keys_.begin() + static_cast<std::ptrdiff_t>(begin_of[r][i]),
                      keys_.begin() + static_cast<std::ptrdiff_t>(end_of[r][i]), end);
    }
    chosen[i].end = static_cast<std::size_t>(end - keys_.begin());
  }
}

// Few references have an end in the bins: codes are looked at two at a time, and what is found is
// written without a branch.
void PlaneSearch::gather_run(std::span<const Reference> run, const BinCode* codes,
                             const BinGrid& grid, Cursors& cursors) {
  constexpr std::size_t kBlock = 512;
  std::array<BinCode, kBlock> own;
  std::array<std::uint16_t, kBlock + 1> found;
  for (std::size_t begin = 0; begin < run.size(); begin += kBlock) {
    const auto block = run.subspan(begin, std::min(kBlock, run.size() - begin));
    const BinCode* of_block = codes == nullptr ? own.data() : codes + begin;
    if (codes == nullptr) {
      for (std::size_t i = 0; i < block.size(); ++i) own[i] = code_of(grid, block[i]);
    }
    const std::size_t n = wanted_.find({of_block, block.size()}, found.data());
    for (std::size_t k = 0; k < n; ++k) {
      const Reference& r = block[found[k]];
      const BinCode code = of_block[found[k]];
      for (std::size_t a = 0; a < 3; ++a) {
        if ((wanted_.axes >> (8 * a) & 0xFF) == 0) continue;
        const bool planar = r.lo[a] == r.hi[a];
        const std::uint32_t at_lo = segment_of_[a][code >> (8 * a) & 0xFF];
        keys_[cursors[at_lo]] =
            make_event(r.lo[a], planar ? EventType::kPlanar : EventType::kStart, 0);
        cursors[at_lo] += at_lo + 1 < cursors.size() ? 1U : 0U;
        const std::uint32_t at_hi = segment_of_[a][code >> (8 * a + 32) & 0xFF];
        keys_[cursors[at_hi]] = make_event(r.hi[a], EventType::kEnd, 0);
        cursors[at_hi] += at_hi + 1 < cursors.size() && !planar ? 1U : 0U;
      }
    }
  }
}

}  // namespace raykiln::render
