#include "cell_bins.hpp"

#include <algorithm>
#include <limits>

namespace raykiln::render {

BinGrid::BinGrid(const Bounds3f& cell, std::size_t count) : count_(count) {
  const auto n = static_cast<float>(count);
  last_ = Float4{n - 1.0F, n - 1.0F, n - 1.0F, 0.0F};
  const int top = static_cast<int>(count) + 1;
  top_ = Int4{top, top, top, top};
  lo_ = hi_ = scale_ = Float4{0.0F, 0.0F, 0.0F, 0.0F};
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    const float width = cell.hi[axis] - cell.lo[axis];
    const float scale = n / width;
    const bool usable =
        width <= std::numeric_limits<float>::max() && scale <= std::numeric_limits<float>::max();
    lo_[axis] = cell.lo[axis];
    hi_[axis] = cell.hi[axis];
    scale_[axis] = usable ? scale : 0.0F;
    // (x - lo) * scale and scale itself err by 3 * 2^-24 of at most kMaxBins: by less than 2^-14
    // bins. When nothing is known of where a bin lies, its edges may be anywhere in the cell.
    const double extent = static_cast<double>(cell.hi[axis]) - static_cast<double>(cell.lo[axis]);
    step_[a] = extent / static_cast<double>(count);
    slack_[a] = usable ? step_[a] * 0x1p-12 : extent;
  }
}

void BinCounts::clear(std::size_t bins) {
  for (auto* rows : {&starts, &ends, &planars}) {
    for (Row& row : *rows) std::fill_n(row.begin(), bins + 2, 0U);
  }
}

void BinCounts::add(const BinCounts& other, std::size_t bins) {
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t b = 0; b < bins + 2; ++b) {
      starts[a][b] += other.starts[a][b];
      ends[a][b] += other.ends[a][b];
      planars[a][b] += other.planars[a][b];
    }
  }
}

void BinCounts::count(const BinGrid& grid, std::span<const Reference> references) {
  for (const Reference& r : references) {
    const Float4 lo = load3(r.lo);
    const Float4 hi = load3(r.hi);
    const Int4 first = grid.bins_of(lo);
    const Int4 last = grid.bins_of(hi);
    const Int4 planar = lo == hi;
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      ++starts[a][static_cast<std::size_t>(first[axis])];
      ++ends[a][static_cast<std::size_t>(last[axis])];
      planars[a][static_cast<std::size_t>(first[axis])] -=
          static_cast<std::uint32_t>(planar[axis]);
    }
  }
}

}  // namespace raykiln::render
