#include "raykiln/sampling/sobol.hpp"

namespace raykiln::render {
namespace sobol {
namespace {

/// What a dimension of Sobol' starts from: a primitive polynomial modulo 2, without its first and last
/// coefficient, and as many odd numbers as it has degrees.
struct Start {
  unsigned degree;
  std::uint32_t coefficients;
  std::array<std::uint32_t, 3> numbers;
};

/// m_j = 2^s m_(j-s) ^ m_(j-s) ^ XOR over k of 2^k a_k m_(j-k) (Bratley & Fox 1988).
constexpr std::array<std::uint32_t, 32> direction_numbers(const Start& start) {
  std::array<std::uint32_t, 32> m{};
  for (unsigned j = 0; j < 32; ++j) {
    if (j < start.degree) {
      m[j] = start.numbers[j];
      continue;
    }
    const std::uint32_t last = m[j - start.degree];
    m[j] = (last << start.degree) ^ last;
    for (unsigned k = 1; k < start.degree; ++k) {
      if (((start.coefficients >> (start.degree - 1 - k)) & 1U) != 0) m[j] ^= m[j - k] << k;
    }
  }
  return m;
}

constexpr Columns columns_of(const Start& start) {
  const auto m = direction_numbers(start);
  Columns columns;
  for (unsigned i = 0; i < 8; ++i) {
    for (unsigned digits = 0; digits < 16; ++digits) {
      for (unsigned bit = 0; bit < 4; ++bit) {
        const unsigned j = 4 * i + bit;
        if (((digits >> bit) & 1U) != 0) columns.of_digits[i][digits] ^= reversed(m[j] << (31 - j));
      }
    }
  }
  return columns;
}

}  // namespace

// x^2 + x + 1 and x^3 + x + 1.
constinit const Columns kThird = columns_of({2, 1, {1, 3, 0}});
constinit const Columns kFourth = columns_of({3, 1, {1, 3, 1}});

}  // namespace sobol

double sobol_number(std::uint64_t a, std::uint64_t b, SequencePoint point, std::uint32_t slot) {
  using namespace sobol;
  // Slots of the plain numbers are 1 to 16 in this place, groups 17 to 20.
  const std::uint64_t group = keyed::mix(a + (17 + slot / 4) * keyed::kGolden, b);
  const unsigned dimension = kDimensionOfSlot[slot & 15U];
  const std::uint64_t own = keyed::mix(group + (dimension + 1) * keyed::kGolden, keyed::kRootTwo);
  const std::uint32_t index =
      reversed(scrambled(point.reversed_index(), static_cast<std::uint32_t>(group)));
  const std::uint32_t digits =
      reversed(scrambled(coordinate(index, dimension), static_cast<std::uint32_t>(own >> 32)));
  const std::uint64_t further = ((digits ^ own) * keyed::kGolden) >> 43;
  return static_cast<double>((std::uint64_t{digits} << 21) | further) * 0x1p-53;
}

}  // namespace raykiln::render
