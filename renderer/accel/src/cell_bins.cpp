#include "cell_bins.hpp"

#include <algorithm>
#include <limits>

namespace raykiln::render {

BinGrid::BinGrid(const Bounds3f& cell, std::size_t count) : count_(count) {
  const auto n = static_cast<float>(count);
  last_ = Float4{n - 1.0F, n - 1.0F, n - 1.0F, 0.0F};
  lo_ = scale_ = Float4{0.0F, 0.0F, 0.0F, 0.0F};
  hi_ = Float4{0.0F, 0.0F, 0.0F, 1.0F};
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    const float width = cell.hi[axis] - cell.lo[axis];
    const float scale = n / width;
    const bool usable =
        width <= std::numeric_limits<float>::max() && scale <= std::numeric_limits<float>::max();
    lo_[axis] = cell.lo[axis];
    hi_[axis] = cell.hi[axis];
    scale_[axis] = usable ? scale : 0.0F;
    if (!(width > 0.0F)) hi_[axis] = std::numeric_limits<float>::infinity();  // all in the lower face
    // (x - lo) * scale and scale itself err by 3 * 2^-24 of at most kMaxBins: by less than 2^-14
    // bins. When nothing is known of where a bin lies, its edges may be anywhere in the cell.
    const double extent = static_cast<double>(cell.hi[axis]) - static_cast<double>(cell.lo[axis]);
    step_[a] = extent / static_cast<double>(count);
    slack_[a] = usable ? step_[a] * 0x1p-12 : extent;
  }
}

void BinCounts::clear(std::size_t bins) {
  for (auto* rows : {&starts, &ends}) {
    for (Row& row : *rows) std::fill_n(row.begin(), bins + 2, 0U);
  }
}

void BinCounts::add(const BinCounts& other, std::size_t bins) {
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t b = 0; b < bins + 2; ++b) {
      starts[a][b] += other.starts[a][b];
      ends[a][b] += other.ends[a][b];
    }
  }
}

void BinCounts::count(const BinGrid& grid, std::span<const Reference> references, BinCode* codes) {
  for (std::size_t i = 0; i < references.size(); ++i) {
    const BinCode code = code_of(grid, references[i]);
    if (codes != nullptr) codes[i] = code;
    for (std::size_t a = 0; a < 3; ++a) {
      ++starts[a][code >> (8 * a) & 0xFF];
      ++ends[a][code >> (8 * a + 32) & 0xFF];
    }
  }
}

std::size_t WantedBins::find(std::span<const BinCode> codes, std::uint16_t* found) const {
  using Byte16 = std::uint8_t __attribute__((vector_size(16)));
  using Pair = std::array<std::uint64_t, 2>;
  const auto twice = [](BinCode x) { return std::bit_cast<Byte16>(Pair{x, x}); };
  const Byte16 low = twice(first), width = twice(span), used = twice(axes);
  std::size_t n = 0;
  for (std::size_t i = 0; i < codes.size(); i += 2) {
    const bool alone = i + 1 == codes.size();
    const Byte16 bins = std::bit_cast<Byte16>(Pair{codes[i], codes[alone ? i : i + 1]});
    const auto hit = std::bit_cast<Pair>(std::bit_cast<Byte16>((bins - low) <= width) & used);
    found[n] = static_cast<std::uint16_t>(i);
    n += hit[0] != 0 ? 1U : 0U;
    found[n] = static_cast<std::uint16_t>(i + 1);
    n += hit[1] != 0 && !alone ? 1U : 0U;
  }
  return n;
}

}  // namespace raykiln::render
