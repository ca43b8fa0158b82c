// Sums over cells of 1, 2, 4, ... pixels, each level from the one below.
#pragma once

#include <vector>

#include "channel_difference.hpp"

namespace raykiln::render {

/// Sums over pixels; e = weight * difference.
struct BlockSum {
  double sum = 0.0;      ///< of e
  double scale = 0.0;    ///< of weight^2 * scale
  double squares = 0.0;  ///< of e^2
  double fourths = 0.0;  ///< of e^4
  double slack = 0.0;    ///< of weight * tolerated change

  BlockSum& operator+=(const BlockSum& other);
  /// Self-normalised sum, what is tolerated taken off; 0 where nothing differs. `by_differences`: divided
  /// by the differences themselves where they are smaller than the estimated noise.
  [[nodiscard]] double z(bool by_differences = false) const;
};

/// Cells of one level in rows; the last column and row may be cut by the picture's border.
struct CellGrid {
  int columns = 0, rows = 0;
  int side_px = 1;
  std::vector<BlockSum> cells;

  [[nodiscard]] const BlockSum& at(int column, int row) const {
    return cells[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                 static_cast<std::size_t>(column)];
  }
};

/// `tolerated`: change of each pixel that does not count, empty for none.
[[nodiscard]] CellGrid pixel_cells(const ChannelDifference& difference,
                                   const std::vector<double>& tolerated);
/// Cells of twice the side.
[[nodiscard]] CellGrid coarser(const CellGrid& grid);
/// Blocks of twice the side at every cell of the grid, so that they overlap by half.
[[nodiscard]] CellGrid overlapping_blocks(const CellGrid& grid);

}  // namespace raykiln::render
