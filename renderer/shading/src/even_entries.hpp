// Tables over [0, 1] with evenly spaced entries: where an entry stands, and linear interpolation.
#pragma once

#include <algorithm>
#include <cstddef>

namespace raykiln::render {

/// Place in [0, 1] of entry `i` of `count` (at least 2).
inline double entry_place(std::size_t i, std::size_t count) {
  return static_cast<double>(i) / static_cast<double>(count - 1);
}

/// A place in [0, 1] between two of `count` entries; places outside are those of the ends.
struct BetweenEntries {
  std::size_t low;  ///< the entry below; low + 1 is the one above
  double share;     ///< 0 at `low`, 1 at the next

  BetweenEntries(double place, std::size_t count) {
    const double at = std::clamp(place, 0.0, 1.0) * static_cast<double>(count - 1);
    low = std::min(static_cast<std::size_t>(at), count - 2);
    share = at - static_cast<double>(low);
  }

  [[nodiscard]] double of(double a, double b) const { return a + share * (b - a); }
};

}  // namespace raykiln::render
