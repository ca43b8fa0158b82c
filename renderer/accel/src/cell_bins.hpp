// Bins across the three axes of a cell, for bounds on the cost of the planes in each.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <span>

#include "float4.hpp"
#include "reference.hpp"

namespace raykiln::render {

inline constexpr std::size_t kMaxBins = 252;  ///< with the two of the faces they fit into a byte

/// Maps positions to bins 1..count, and to 0 and count + 1 what stands in the cell's faces. Monotone
/// in every axis, so that bins are in the order of the sweep and equal positions share one.
class BinGrid {
 public:
  BinGrid(const Bounds3f& cell, std::size_t count);

  [[nodiscard]] Int4 bins_of(Float4 x) const {
    Float4 t = (x - lo_) * scale_;
    t = t < last_ ? t : last_;  // also what is not a number, where the cell is wider than floats
    return __builtin_convertvector(t, Int4) - (x > lo_) - (x >= hi_);  // true is -1
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
  std::size_t count_;
  std::array<double, 3> step_, slack_;
};

/// Where a reference begins and ends: a byte each for the bins of lo.x, lo.y, lo.z, then from the
/// fifth on of hi.x, hi.y, hi.z, the lowest first.
using BinCode = std::uint64_t;

[[nodiscard]] inline BinCode code_of(const BinGrid& grid, const Reference& r) {
  const Int4 first = grid.bins_of(load3(r.lo));
  const Int4 last = grid.bins_of(load3(r.hi));
  using Short4 = std::int16_t __attribute__((vector_size(8)));
  using Short8 = std::int16_t __attribute__((vector_size(16)));
  using Byte8 = std::uint8_t __attribute__((vector_size(8)));
  const Short8 both = __builtin_shufflevector(__builtin_convertvector(first, Short4),
                                              __builtin_convertvector(last, Short4), 0, 1, 2, 3, 4, 5, 6, 7);
  return std::bit_cast<BinCode>(__builtin_convertvector(both, Byte8));
}

/// Bins to look for: all between the outermost of each axis, to test every byte of a code at once.
struct WantedBins {
  BinCode first = 0, span = 0, axes = 0;  ///< a byte each; those of `axes` are 0xFF or 0

  void add(std::size_t axis, std::size_t bin) {
    const auto shift = static_cast<unsigned>(8 * axis);
    const std::uint64_t in_both = 0x1'0000'0001ULL << shift;
    const std::uint64_t lowest = axes >> shift & 0xFF ? first >> shift & 0xFF : bin;
    const std::uint64_t highest = axes >> shift & 0xFF ? lowest + (span >> shift & 0xFF) : bin;
    first = (first & ~(0xFF * in_both)) | std::min<std::uint64_t>(lowest, bin) * in_both;
    const std::uint64_t width = std::max<std::uint64_t>(highest, bin) - std::min<std::uint64_t>(lowest, bin);
    span = (span & ~(0xFF * in_both)) | width * in_both;
    axes |= 0xFF * in_both;
  }
  /// Writes the places of codes with a wanted byte, and may write one more; gives their number.
  std::size_t find(std::span<const BinCode> codes, std::uint16_t* found) const;
};

/// How many extents of the references begin and end, by axis and bin.
struct BinCounts {
  using Row = std::array<std::uint32_t, kMaxBins + 2>;
  std::array<Row, 3> starts, ends;

  void clear(std::size_t bins);
  void add(const BinCounts& other, std::size_t bins);
  /// Writes the codes, too, unless `codes` is null.
  void count(const BinGrid& grid, std::span<const Reference> references, BinCode* codes);
};

}  // namespace raykiln::render
