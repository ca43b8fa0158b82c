// Bins across the three axes of a cell, for bounds on the cost of the planes in each.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "float4.hpp"
#include "reference.hpp"

namespace raykiln::render {

inline constexpr std::size_t kMaxBins = 256;

/// Maps positions to bins 1..count, and to 0 and count + 1 what stands in the cell's faces. Monotone
/// in every axis, so that bins are in the order of the sweep and equal positions share one.
class BinGrid {
 public:
  BinGrid(const Bounds3f& cell, std::size_t count);

  [[nodiscard]] Int4 bins_of(Float4 x) const {
    Float4 t = (x - lo_) * scale_;
    t = t < last_ ? t : last_;  // also what is not a number, where the cell is wider than floats
    Int4 bin = __builtin_convertvector(t, Int4) + 1;
    bin &= ~(x <= lo_);
    const Int4 in_top_face = x >= hi_;
    return (bin & ~in_top_face) | (top_ & in_top_face);
  }
  [[nodiscard]] std::size_t count() const { return count_; }

  /// Distance of the upper edge of a bin from the cell's lower face; bin 0 ends there. Positions of
  /// the bin are within its edges, give or take edge_slack.
  [[nodiscard]] double edge(std::size_t axis, std::size_t bin) const {
    return static_cast<double>(bin) * step_[axis];
  }
  [[nodiscard]] double edge_slack(std::size_t axis) const { return slack_[axis]; }

 private:
  Float4 lo_, hi_, scale_, last_;
  Int4 top_;
  std::size_t count_;
  std::array<double, 3> step_, slack_;
};

/// How many extents of the references begin, end, and do both at one position, by axis and bin.
struct BinCounts {
  using Row = std::array<std::uint32_t, kMaxBins + 2>;
  std::array<Row, 3> starts;   ///< planar ones too
  std::array<Row, 3> ends;     ///< planar ones too
  std::array<Row, 3> planars;

  void clear(std::size_t bins);
  void add(const BinCounts& other, std::size_t bins);
  void count(const BinGrid& grid, std::span<const Reference> references);
};

}  // namespace raykiln::render
