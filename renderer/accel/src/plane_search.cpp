#include "plane_search.hpp"

#include <algorithm>
#include <limits>

namespace raykiln::render {
namespace {

// Bins pay when they are fewer than events by far; the share of events that survive falls like
// the root of their number.
std::size_t bin_count(std::uint32_t n) {
  if (n < 64) return 16;
  if (n < 1024) return 32;
  return n < 8192 ? 64 : kMaxBins;
}

constexpr float kRoundingSlack = 1e-6F;

}  // namespace

SweepResult PlaneSearch::find(Runs runs, const SweepInput& input, double leaf_cost, bool parallel,
                              BuildStats& counts) {
  if (runs.size() == 1 && input.n <= kCountingMax) {
    return search_by_counting(context_, runs[0], input, leaf_cost, counts);
  }
  const BuildParams& params = context_.params;
  const BinGrid grid(input.cell, bin_count(input.n));
  count_bins(runs, grid, parallel);
  counts.events_swept += 6 * std::uint64_t{input.n};
  choose_segments(grid, input, leaf_cost);
  Choosers choosers{PlaneChooser(0, input, params), PlaneChooser(1, input, params),
                    PlaneChooser(2, input, params)};
  look_into_segments(runs, grid, input, leaf_cost, parallel, choosers, counts);
  BestOfAxes best;
  for (const PlaneChooser& chooser : choosers) best.take(chooser.result());
  return best.result;
}

void PlaneSearch::count_bins(Runs runs, const BinGrid& grid, bool parallel) {
  bins_.clear(grid.count());
  first_code_.clear();
  std::size_t n = 0;
  for (const auto run : runs) {
    first_code_.push_back(n);
    n += run.size();
  }
  if (codes_.size() < n) codes_.resize(n);
  if (!parallel) {
    for (std::size_t i = 0; i < runs.size(); ++i) {
      if (looks_for_stop(runs[i].size())) return;
      bins_.count(context_.kernels, grid, runs[i], codes_.data() + first_code_[i]);
    }
    return;
  }
  run_bins_.resize(runs.size());
  context_.for_each(runs.size(), [&](std::size_t i) {
    run_bins_[i].clear(grid.count());
    if (context_.stopped()) return;
    run_bins_[i].count(context_.kernels, grid, runs[i], codes_.data() + first_code_[i]);
  });
  for (const BinCounts& counted : run_bins_) bins_.add(counted);
}

void PlaneSearch::choose_segments(const BinGrid& grid, const SweepInput& input, double leaf_cost) {
  segments_.clear();
  rough_ = rough_costs(input.cell, context_.params);
  const std::size_t bins = grid.count();
  auto threshold = static_cast<float>(leaf_cost);
  const auto budget = static_cast<std::int32_t>(std::min<std::uint64_t>(input.budget, input.n));
  for (std::size_t a = 0; a < 3; ++a) {
    const float best_at_most = context_.kernels.bound_bins(
        {bins_.starts(a), bins_.ends(a), bins, input.n, budget,
         rough_[a], grid.edges_known(a)},
        bounds_[a]);
    threshold = std::min(threshold, best_at_most);
  }
  threshold = std::min(threshold * (1.0F + kRoundingSlack), std::numeric_limits<float>::max());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const BinBounds& b = bounds_[axis];
    for (std::size_t i = 1; i <= bins; ++i) {
      if (b.least[i] > threshold) continue;
      segments_.push_back({axis, i, static_cast<double>(b.least[i]),
                           static_cast<std::uint32_t>(b.n_left[i]),
                           static_cast<std::uint32_t>(b.n_gone[i]),
                           b.n_left[i] - b.n_gone[i + 1] > budget, 0, 0});
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
  KnownCosts known{leaf_cost, std::numeric_limits<double>::infinity()};
  look_into(first_, runs, grid, input, known, parallel, choosers, counts);
  std::erase_if(segments_, [&](const Segment& s) { return s.least > known.limit(s.beyond); });
  if (segments_.empty() || looks_for_stop(input.n)) return;
  look_into(segments_, runs, grid, input, known, parallel, choosers, counts);
}

void PlaneSearch::look_into(Segments& chosen, Runs runs, const BinGrid& grid,
                            const SweepInput& input, KnownCosts& known, bool parallel,
                            Choosers& choosers, BuildStats& counts) {
  place(chosen, grid.count(), runs.size());
  for (std::size_t a = 0; a < 3; ++a) {
    if (wanted_.has(a)) counts.events_swept += 2 * std::uint64_t{input.n};
  }
  gather(chosen, runs, parallel);
  for (const Segment& s : chosen) {
    if (s.least > known.limit(s.beyond)) continue;
    const std::span<EventKey> keys = std::span(keys_).subspan(s.begin, s.end - s.begin);
    if (looks_for_stop(keys.size())) return;
    bin_search_.run(keys, input, s.n_left, s.n_gone, rough_[s.axis], known, choosers[s.axis], counts);
    known.take(choosers[s.axis].result());
  }
}

// Room for the keys of the chosen bins, and one more a run for what is not wanted.
void PlaneSearch::place(Segments& chosen, std::size_t bins, std::size_t runs) {
  wanted_ = {};
  const auto none = static_cast<std::uint32_t>(chosen.size());
  std::size_t keys = 0;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    Segment& s = chosen[i];
    if (!wanted_.has(s.axis)) std::fill_n(segment_of_[s.axis].begin(), bins + 2, none);
    segment_of_[s.axis][s.bin] = static_cast<std::uint32_t>(i);
    wanted_.add(s.axis, s.bin);
    s.begin = s.end = keys;
    keys += bins_.in(s.axis, s.bin);
  }
  if (keys_.size() < keys + runs) keys_.resize(keys + runs);
  waste_ = keys;
}

void PlaneSearch::gather(Segments& chosen, Runs runs, bool parallel) {
  cursors_.resize(chosen.size() + 1);
  for (std::size_t i = 0; i < chosen.size(); ++i) cursors_[i] = chosen[i].begin;
  cursors_.back() = waste_;
  if (!parallel) {
    for (std::size_t i = 0; i < runs.size(); ++i) {
      if (looks_for_stop(runs[i].size())) break;
      gather_run(runs[i], codes_.data() + first_code_[i], cursors_);
    }
    for (std::size_t i = 0; i < chosen.size(); ++i) chosen[i].end = cursors_[i];
    return;
  }
  std::vector<Cursors> begin_of(runs.size()), end_of(runs.size());
  for (std::size_t r = 0; r < runs.size(); ++r) {
    begin_of[r] = end_of[r] = cursors_;
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      cursors_[i] += run_bins_[r].in(chosen[i].axis, chosen[i].bin);
    }
    ++cursors_.back();
  }
  context_.for_each(runs.size(), [&](std::size_t r) {
    if (!context_.stopped()) gather_run(runs[r], codes_.data() + first_code_[r], end_of[r]);
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

// Few references have an end in the bins: codes are looked at four at a time, and what is found is
// written without a branch, if need be to where nobody looks.
void PlaneSearch::gather_run(std::span<const Reference> run, const BinCode* codes,
                             Cursors& cursors) {
  constexpr std::size_t kBlock = 512;
  std::array<std::uint16_t, kBlock + 4> found;
  EventKey* const keys = keys_.data();
  std::size_t* const place_of = cursors.data();
  const auto none = static_cast<std::uint32_t>(cursors.size() - 1);
  for (std::size_t begin = 0; begin < run.size(); begin += kBlock) {
    const auto block = run.subspan(begin, std::min(kBlock, run.size() - begin));
    const BinCode* const of_block = codes + begin;
    const std::size_t n = context_.kernels.find_codes(of_block, block.size(), wanted_.first,
                                                      wanted_.span, wanted_.axes, found.data());
    for (std::size_t k = 0; k < n; ++k) {
      const Reference& r = block[found[k]];
      const BinCode code = of_block[found[k]];
      for (std::size_t a = 0; a < 3; ++a) {
        if (!wanted_.has(a)) continue;
        const bool planar = r.lo[a] == r.hi[a];
        const std::uint32_t at_lo = segment_of_[a][code >> (8 * a) & 0xFF];
        keys[place_of[at_lo]] =
            make_event(r.lo[a], planar ? EventType::kPlanar : EventType::kStart, 0);
        place_of[at_lo] += at_lo != none ? 1U : 0U;
        const std::uint32_t at_hi = segment_of_[a][code >> (8 * a + 32) & 0xFF];
        keys[place_of[at_hi]] = make_event(r.hi[a], EventType::kEnd, 0);
        place_of[at_hi] += static_cast<std::size_t>((at_hi != none) & !planar);
      }
    }
  }
}

}  // namespace raykiln::render
