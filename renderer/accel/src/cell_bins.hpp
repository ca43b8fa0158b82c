// Bins across the three axes of a cell, for bounds on the cost of the planes in each.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "build_kernels.hpp"
#include "reference.hpp"

namespace raykiln::render {

/// Maps positions to bins 1..count, and to 0 and count + 1 what stands in the cell's faces. Monotone
/// in every axis, so that bins are in the order of the sweep and equal positions share one. A bin of a
/// position x is floor((x - lo) scale), at most `last`, and one more for each of x > lo and x >= hi.
class BinGrid {
 public:
  BinGrid(const Bounds3f& cell, std::size_t count);

  [[nodiscard]] const BinScale& scale() const { return scale_; }
  [[nodiscard]] std::size_t count() const { return count_; }
  /// The bins are where their numbers say, but for 2^-12 of a bin.
  [[nodiscard]] bool edges_known(std::size_t axis) const { return known_[axis]; }

 private:
  BinScale scale_{};
  std::array<bool, 3> known_{};
  std::size_t count_;
};

/// Bins to look for: all between the outermost of each axis, to test every byte of a code at once.
struct WantedBins {
  BinCode first = 0, span = 0, axes = 0;  ///< a byte each; those of `axes` are 0xFF or 0

  void add(std::size_t axis, std::size_t bin) {
    const auto shift = static_cast<unsigned>(8 * axis);
    const std::uint64_t in_both = 0x1'0000'0001ULL << shift;
    const bool known = has(axis);
    const std::uint64_t lowest = known ? first >> shift & 0xFF : bin;
    const std::uint64_t highest = known ? lowest + (span >> shift & 0xFF) : bin;
    const std::uint64_t from = std::min<std::uint64_t>(lowest, bin);
    first = (first & ~(0xFF * in_both)) | from * in_both;
    span = (span & ~(0xFF * in_both)) | (std::max<std::uint64_t>(highest, bin) - from) * in_both;
    axes |= 0xFF * in_both;
  }
  [[nodiscard]] bool has(std::size_t axis) const { return (axes >> (8 * axis) & 0xFF) != 0; }
};

/// How many extents of the references begin and end, by axis and bin.
class BinCounts {
 public:
  void clear(std::size_t bins);
  void add(const BinCounts& other);
  void count(const BuildKernels& kernels, const BinGrid& grid, std::span<const Reference> references,
             BinCode* codes);

  /// By bin, that of the lower face first.
  [[nodiscard]] const std::uint32_t* starts(std::size_t axis) const { return rows_.data() + axis * row_; }
  [[nodiscard]] const std::uint32_t* ends(std::size_t axis) const { return starts(axis + 3); }
  /// Of both kinds.
  [[nodiscard]] std::uint32_t in(std::size_t axis, std::size_t bin) const {
    return starts(axis)[bin] + ends(axis)[bin];
  }

 private:
  std::size_t row_ = 0;  ///< length of one of the six
  std::array<std::uint32_t, 6 * (kMaxBins + 2)> rows_;
};

}  // namespace raykiln::render
