// The cheapest plane among the events of one bin, of which most need not be sorted.
#pragma once

#include <vector>

#include "sah_sweep.hpp"

namespace raykiln::render {

/// Costs of planes that were seen: beyond the budget the cheapest alone is of interest.
struct KnownCosts {
  double least;         ///< within the budget, or of a leaf
  double unaffordable;  ///< beyond it
  /// What more is worth a look may cost.
  [[nodiscard]] double limit(bool beyond) const { return beyond ? std::min(least, unaffordable) : least; }
  void take(const SweepResult& found) {
    least = std::min(least, found.best.cost);
    unaffordable = std::min(unaffordable, found.unaffordable);
  }
};

/// Few events: the sides of all their planes are counted. More: they are dealt to buckets across the
/// bin, and buckets that cannot hold the cheapest plane are passed over.
class BinSearch {
 public:
  explicit BinSearch(BuildContext& context) : context_(context) {}

  using Known = KnownCosts;

  /// Offers all planes of `events` that may cost less than what is known, or as much. `n_left` triangles begin and `n_gone` end before the first event. Events lose their order.
  void run(std::span<EventKey> events, const SweepInput& input, std::uint32_t n_left,
           std::uint32_t n_gone, const RoughCost& rough, const Known& known, PlaneChooser& chooser,
           BuildStats& counts);

 private:
  struct Search {
    const SweepInput& input;
    const RoughCost& rough;
    PlaneChooser& chooser;
    BuildStats& counts;
    Known before;
    [[nodiscard]] Known known() const {
      Known known = before;
      known.take(chooser.result());
      return known;
    }
  };
  // The place of each event in `other` is a place for it.
  void look(const Search& search, std::span<EventKey> events, EventKey* other, std::uint32_t n_left,
            std::uint32_t n_gone);
  void deal(const Search& search, std::span<EventKey> events, EventKey* other, std::uint32_t n_left,
            std::uint32_t n_gone);
  void count(const Search& search, std::span<const EventKey> events, std::uint32_t n_left,
             std::uint32_t n_gone);

  BuildContext& context_;
  std::vector<EventKey> other_;
};

}  // namespace raykiln::render
