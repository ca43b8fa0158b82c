#include "plane_search.hpp"

#include <algorithm>
#include <limits>

#include "key_sort.hpp"

namespace raykiln::render {
namespace {

constexpr std::uint32_t kNoSegment = 0xFFFFFFFFU;

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
    if (!segments_.empty() && !looks_for_stop(input.n)) {
      gather(runs, grid, parallel);
      for (const bool used : gathered_) counts.events_swept += used ? 2 * std::uint64_t{input.n} : 0;
      sweep_segments(input, leaf_cost, choosers, counts);
    }
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
    for (const auto run : runs) {
      if (looks_for_stop(run.size())) return;
      bins_.count(grid, run);
    }
    return;
  }
  run_bins_.resize(runs.size());
  context_.for_each(runs.size(), [&](std::size_t i) {
    run_bins_[i].clear(grid.count());
    if (!context_.stopped()) run_bins_[i].count(grid, runs[i]);
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
  gathered_ = {};
  for (auto& row : segment_of_) std::fill_n(row.begin(), grid.count() + 2, kNoSegment);
  std::size_t keys = 0;
  for (std::size_t i = 0; i < segments_.size(); ++i) {
    Segment& s = segments_[i];
    gathered_[s.axis] = true;
    segment_of_[s.axis][s.bin] = static_cast<std::uint32_t>(i);
    s.begin = keys;
    keys += bins_.starts[s.axis][s.bin] + bins_.ends[s.axis][s.bin] - bins_.planars[s.axis][s.bin];
    s.end = keys;
  }
  if (keys_.size() < keys) keys_.resize(keys);
}

void PlaneSearch::gather(Runs runs, const BinGrid& grid, bool parallel) {
  Cursors cursors(segments_.size());
  for (std::size_t i = 0; i < segments_.size(); ++i) cursors[i] = segments_[i].begin;
  if (!parallel) {
    for (const auto run : runs) {
      if (looks_for_stop(run.size())) return;
      gather_run(run, grid, cursors.data());
    }
    return;
  }
  std::vector<Cursors> of_run(runs.size());
  for (std::size_t r = 0; r < runs.size(); ++r) {
    of_run[r] = cursors;
    const BinCounts& bins = run_bins_[r];
    for (std::size_t i = 0; i < segments_.size(); ++i) {
      const Segment& s = segments_[i];
      cursors[i] += bins.starts[s.axis][s.bin] + bins.ends[s.axis][s.bin] -
                    bins.planars[s.axis][s.bin];
    }
  }
  context_.for_each(runs.size(), [&](std::size_t r) {
    if (!context_.stopped()) gather_run(runs[r], grid, of_run[r].data());
  });
}

void PlaneSearch::gather_run(std::span<const Reference> run, const BinGrid& grid,
                             std::size_t* cursors) {
  for (const Reference& r : run) {
    const Int4 first = grid.bins_of(load3(r.lo));
    const Int4 last = grid.bins_of(load3(r.hi));
    for (std::size_t a = 0; a < 3; ++a) {
      if (!gathered_[a]) continue;
      const bool planar = r.lo[a] == r.hi[a];
      const std::uint32_t at_lo = segment_of_[a][static_cast<std::size_t>(first[a])];
      if (at_lo != kNoSegment) {
        keys_[cursors[at_lo]++] =
            make_event(r.lo[a], planar ? EventType::kPlanar : EventType::kStart, 0);
      }
      const std::uint32_t at_hi = segment_of_[a][static_cast<std::size_t>(last[a])];
      if (at_hi != kNoSegment && !planar) {
        keys_[cursors[at_hi]++] = make_event(r.hi[a], EventType::kEnd, 0);
      }
    }
  }
}

// The most promising bin first, so that its best plane rules out most of the others.
void PlaneSearch::sweep_segments(const SweepInput& input, double leaf_cost, Choosers& choosers,
                                 BuildStats& counts) {
  double best = leaf_cost;
  const auto sweep_one = [&](const Segment& s) {
    const std::span<EventKey> keys = std::span(keys_).subspan(s.begin, s.end - s.begin);
    counts.keys_sorted_passes += sort_keys(keys, kEventIdBits, sort_scratch_, &context_);
    counts.events_swept += keys.size();
    sweep(keys, input, static_cast<int>(s.axis), s.n_left, s.n_gone, choosers[s.axis]);
    best = std::min(best, choosers[s.axis].result().best.cost);
  };
  const auto first = std::min_element(
      segments_.begin(), segments_.end(),
      [](const Segment& a, const Segment& b) { return a.least < b.least; });
  sweep_one(*first);
  for (auto s = segments_.begin(); s != segments_.end(); ++s) {
    if (s == first || s->least > best) continue;
    if (looks_for_stop(s->end - s->begin)) return;
    sweep_one(*s);
  }
}

}  // namespace raykiln::render
