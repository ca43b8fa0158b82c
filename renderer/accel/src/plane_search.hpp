// The cheapest plane of a cell, exactly, without keeping events sorted.
//
// Large cells: counts in bins bound the cost of all planes of a bin from both sides; only bins that
// may hold the cheapest plane have their events gathered and searched (bin_search.hpp). Small cells:
// sides are counted for the planes that a few marks leave. Both give what a sweep over all sorted events gives, ties included.
#pragma once

#include <array>
#include <vector>

#include "bin_search.hpp"
#include "cell_bins.hpp"
#include "reference.hpp"
#include "sah_sweep.hpp"

namespace raykiln::render {

class PlaneSearch {
 public:
  explicit PlaneSearch(BuildContext& context) : context_(context), bin_search_(context) {}

  /// The first of the cheapest planes in the order of axis, position and planar_left first, among
  /// those within the budget; if its cost is not below `leaf_cost`, then no plane's is.
  /// `unaffordable` tells the least cost beyond the budget if that is below both. With `parallel`
  /// the runs are counted as tasks. Undefined after a stop.
  [[nodiscard]] SweepResult find(Runs runs, const SweepInput& input, double leaf_cost,
                                 bool parallel, BuildStats& counts);

 private:
  using Choosers = std::array<PlaneChooser, 3>;

  /// The events of one bin that may hold the cheapest plane.
  struct Segment {
    std::size_t axis = 0, bin = 0;
    double least = 0.0;         ///< no plane of the bin costs less
    std::uint32_t n_left = 0;   ///< extents that begin before the bin
    std::uint32_t n_gone = 0;   ///< extents that end before it
    bool beyond = false;        ///< all its planes are beyond the budget
    std::size_t begin = 0, end = 0;  ///< in keys_
  };
  using Cursors = std::vector<std::size_t>;
  using Segments = std::vector<Segment>;

  // Small pieces of work are not worth a look: the caller looks between cells.
  bool looks_for_stop(std::size_t work) { return work >= kStopInterval && context_.stopped(); }
  void count_bins(Runs runs, const BinGrid& grid, bool parallel);
  void choose_segments(const BinGrid& grid, const SweepInput& input, double leaf_cost);
  void look_into_segments(Runs runs, const BinGrid& grid, const SweepInput& input, double leaf_cost,
                          bool parallel, Choosers& choosers, BuildStats& counts);
  // Gathers and searches `chosen`.
  void look_into(Segments& chosen, Runs runs, const BinGrid& grid, const SweepInput& input,
                 KnownCosts& known, bool parallel, Choosers& choosers, BuildStats& counts);
  void place(Segments& chosen, std::size_t bins, std::size_t runs);
  void gather(Segments& chosen, Runs runs, bool parallel);
  void gather_run(std::span<const Reference> run, const BinCode* codes, Cursors& cursors);

  BuildContext& context_;
  BinCounts bins_;
  std::array<BinBounds, 3> bounds_;
  std::vector<BinCounts> run_bins_;  ///< of each run, when they are counted as tasks
  std::vector<std::size_t> first_code_;  ///< of each run, in codes_
  std::vector<BinCode> codes_;       ///< of all references of the cell, run after run
  Segments segments_;                ///< that may hold the cheapest plane
  Segments first_;                   ///< the most promising of them
  std::array<std::array<std::uint32_t, kMaxBins + 2>, 3> segment_of_;
  WantedBins wanted_;
  Cursors cursors_;                  ///< where the next key of each chosen bin goes
  std::size_t waste_ = 0;            ///< where keys that nobody asked for go, one place a run
  std::vector<EventKey> keys_;
  BinSearch bin_search_;
  std::array<RoughCost, 3> rough_{};
};

/// The same for up to kCountingMax references: counts the triangles on both sides of every plane.
[[nodiscard]] SweepResult search_by_counting(const BuildContext& context,
                                             std::span<const Reference> references,
                                             const SweepInput& input, double leaf_cost,
                                             BuildStats& counts);

}  // namespace raykiln::render
