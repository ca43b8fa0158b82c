#include "cell_bins.hpp"

#include <limits>

namespace raykiln::render {

BinGrid::BinGrid(const Bounds3f& cell, std::size_t count) : count_(count) {
  const auto n = static_cast<float>(count);
  scale_.hi[3] = 1.0F;  // a fourth lane stays in bin 0
  for (int axis = 0; axis < 3; ++axis) {
    const float width = cell.hi[axis] - cell.lo[axis];
    const float scale = n / width;
    const bool usable =
        width <= std::numeric_limits<float>::max() && scale <= std::numeric_limits<float>::max();
    scale_.lo[axis] = cell.lo[axis];
    scale_.hi[axis] = width > 0.0F ? cell.hi[axis] : std::numeric_limits<float>::infinity();
    scale_.scale[axis] = usable ? scale : 0.0F;
    scale_.last[axis] = n - 1.0F;
    // (x - lo) * scale and scale itself err by 3 * 2^-24 of at most kMaxBins: by less than 2^-14
    // bins. When nothing is known of where a bin lies, its edges may be anywhere in the cell.
    known_[static_cast<std::size_t>(axis)] = usable;
  }
}

void BinCounts::clear(std::size_t bins) {
  row_ = bins + 2;
  std::fill_n(rows_.begin(), 6 * row_, 0U);
}

void BinCounts::add(const BinCounts& other) {
  for (std::size_t i = 0; i < 6 * row_; ++i) rows_[i] += other.rows_[i];
}

void BinCounts::count(const BuildKernels& kernels, const BinGrid& grid,
                      std::span<const Reference> references, BinCode* codes) {
  std::uint32_t* const rows = rows_.data();
  const BinTables tables{{rows, rows + row_, rows + 2 * row_},
                         {rows + 3 * row_, rows + 4 * row_, rows + 5 * row_}};
  kernels.count_bins(grid.scale(), words_of(references.data()), references.size(), codes, tables);
}

}  // namespace raykiln::render
