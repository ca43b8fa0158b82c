#include "raykiln/sampling/sobol.hpp"

namespace raykiln::render {
namespace sobol {
namespace {

/// Products of the field of four elements, whose bits are the coefficients of 1 and of a root a of x^2 + x + 1.
constexpr std::uint32_t times_root(std::uint32_t x) { return ((x << 1) & 2U) ^ (x >> 1) * 3U; }

/// Pascal's triangle with a^(j - i) beside the binomial of j and i, for digits of four values: the binomial is odd where the set of
/// bits of j holds that of i (Lucas).
constexpr std::uint32_t column(unsigned digit, unsigned bit) {
  std::uint32_t words = 0, power = 1U << bit;
  for (unsigned i = digit + 1; i-- > 0; power = times_root(power)) {
    if ((digit & i) == i) words |= power << (2 * i);
  }
  return words;
}

constexpr Columns third_columns() {
  Columns columns;
  for (unsigned j = 0; j < 32; ++j) {
    for (unsigned digits = 0; digits < 16; ++digits) {
      if (((digits >> (j % 4)) & 1U) != 0) columns.of_digits[j / 4][digits] ^= column(j / 2, j % 2);
    }
  }
  return columns;
}

}  // namespace

constinit const Columns kThird = third_columns();

}  // namespace sobol

double sobol_number(std::uint64_t a, std::uint64_t b, SequencePoint point, std::uint32_t slot) {
  using namespace sobol;
  const auto [number, dimension] = place_of(slot, point.of_first_vertex());
  // Slots of the plain numbers are 1 to 16 in this place, groups 17 to 20.
  const std::uint64_t group = keyed::mix(a + (17U + number) * keyed::kGolden, b);
  const std::uint64_t own = keyed::mix(group + (dimension + 1) * keyed::kGolden, keyed::kRootTwo);
  const std::uint32_t index =
      reversed(scrambled(point.reversed_index(), static_cast<std::uint32_t>(group)));
  const std::uint32_t digits =
      reversed(scrambled(coordinate(index, dimension), static_cast<std::uint32_t>(own >> 32)));
  const std::uint64_t further = ((digits ^ own) * keyed::kGolden) >> 43;
  return static_cast<double>((std::uint64_t{digits} << 21) | further) * 0x1p-53;
}

}  // namespace raykiln::render
