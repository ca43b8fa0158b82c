#include "block_sums.hpp"

#include <algorithm>
#include <cmath>

namespace raykiln::render {
namespace {

/// Cells at (column * step, row * step), each the sum of 2 x 2 of the grid as far as there are any.
CellGrid merged(const CellGrid& grid, int columns, int rows, int step) {
  CellGrid result{.columns = columns, .rows = rows, .side_px = 2 * grid.side_px, .cells = {}};
  result.cells.reserve(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      BlockSum sum;
      for (int r = row * step; r < std::min(row * step + 2, grid.rows); ++r) {
        for (int c = column * step; c < std::min(column * step + 2, grid.columns); ++c) {
          sum += grid.at(c, r);
        }
      }
      result.cells.push_back(sum);
    }
  }
  return result;
}

}  // namespace

BlockSum& BlockSum::operator+=(const BlockSum& other) {
  sum += other.sum;
  scale += other.scale;
  squares += other.squares;
  fourths += other.fourths;
  slack += other.slack;
  return *this;
}

double BlockSum::z(bool by_differences) const {
  const double over = std::max(0.0, std::abs(sum) - slack);
  const double below = by_differences ? std::min(scale, squares) : scale;
  return over > 0.0 && below > 0.0 ? std::copysign(over / std::sqrt(below), sum) : 0.0;
}

CellGrid pixel_cells(const ChannelDifference& d, const std::vector<double>& tolerated) {
  CellGrid grid{.columns = d.width, .rows = d.height, .side_px = 1, .cells = {}};
  grid.cells.resize(d.difference.size());
  for (std::size_t i = 0; i < grid.cells.size(); ++i) {
    const double e = d.weight[i] * d.difference[i];
    grid.cells[i] = {.sum = e,
                     .scale = d.weight[i] * d.weight[i] * d.scale[i],
                     .squares = e * e,
                     .fourths = e * e * e * e,
                     .slack = tolerated.empty() ? 0.0 : d.weight[i] * tolerated[i]};
  }
  return grid;
}

CellGrid coarser(const CellGrid& grid) {
  return merged(grid, (grid.columns + 1) / 2, (grid.rows + 1) / 2, 2);
}

CellGrid overlapping_blocks(const CellGrid& grid) {
  return merged(grid, std::max(1, grid.columns - 1), std::max(1, grid.rows - 1), 1);
}

}  // namespace raykiln::render
