// Owen-scrambled Sobol' points as a pure function of keys: four dimensions at a time, padded.
//
// Burley 2020, "Practical hash-based Owen scrambling" (JCGT 9:4): each group of four dimensions uses the first
// four of Sobol' again, with the order of the points and each coordinate scrambled by hashes of its own.
// Groups are thereby independent of each other, and no table grows with the length of a path.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "raykiln/sampling/mix.hpp"

namespace raykiln::render {

/// A place in a sequence: its index with the first binary digit last, as scrambling wants it.
struct SequencePoint {
  std::uint64_t word = 0;  ///< bit 32 is set for points of a sequence; the lower half is the index
  [[nodiscard]] constexpr bool of_sequence() const { return word != 0; }
  [[nodiscard]] constexpr std::uint32_t reversed_index() const {
    return static_cast<std::uint32_t>(word);
  }
};

/// Which sequence a sample index belongs to and where it stands there.
struct SequencePlace {
  std::uint64_t sequence = 0;  ///< number mod 4: the replicate; +4 every 2^32 points of it
  SequencePoint point;
};

namespace sobol {

constexpr std::uint32_t reversed(std::uint32_t x) {
  x = ((x >> 1) & 0x55555555U) | ((x & 0x55555555U) << 1);
  x = ((x >> 2) & 0x33333333U) | ((x & 0x33333333U) << 2);
  x = ((x >> 4) & 0x0F0F0F0FU) | ((x & 0x0F0F0F0FU) << 4);
  return __builtin_bswap32(x);
}

/// A permutation of 32-bit words in which every bit depends on those below it and on the seed alone
/// (Laine & Karras 2011, "Stratified sampling for stochastic transparency"), with Vegdahl's constants
/// (2021, "Building a better LK hash"). Of words whose first binary digit is their lowest bit it is a
/// nested uniform scramble (Owen 1995).
constexpr std::uint32_t scrambled(std::uint32_t x, std::uint32_t seed) {
  x ^= x * 0x3D20ADEAU;
  x += seed;
  x *= (seed >> 16) | 1U;
  x ^= x * 0x05526C56U;
  x ^= x * 0x53A22864U;
  return x;
}

/// Columns of the generator matrices of the third and fourth dimension, joined for every value of four
/// digits of the index.
struct Columns {
  std::array<std::array<std::uint32_t, 16>, 8> of_digits{};
};
extern const Columns kThird, kFourth;

constexpr std::uint32_t product(const Columns& columns, std::uint32_t index) {
  std::uint32_t x = 0;
  for (unsigned i = 0; i < 8; ++i) x ^= columns.of_digits[i][(index >> (4 * i)) & 15U];
  return x;
}

/// Pascal's triangle modulo 2 times the index: digit k is the sum of all digits j whose set of bits
/// holds that of k. Five steps, one a bit of j (Ahmed 2024, "An implementation algorithm of 2D Sobol
/// sequence fast, elegant, and compact").
constexpr std::uint32_t pascal_product(std::uint32_t x) {
  x ^= (x >> 1) & 0x55555555U;
  x ^= (x >> 2) & 0x33333333U;
  x ^= (x >> 4) & 0x0F0F0F0FU;
  x ^= (x >> 8) & 0x00FF00FFU;
  return x ^ (x >> 16);
}

/// Coordinate `dimension` (0 .. 3) of Sobol' point `index`, its first binary digit in the lowest bit.
/// Direction numbers of Joe & Kuo (2008).
constexpr std::uint32_t coordinate(std::uint32_t index, unsigned dimension) {
  switch (dimension) {
    case 0: return index;
    case 1: return pascal_product(index);
    case 2: return product(kThird, index);
    default: return product(kFourth, index);
  }
}

/// Which Sobol' dimension a slot uses. The first two fill squares best, so the pairs (place in the
/// pixel, direction, place on a light, direction to the environment) have them; choices come after.
inline constexpr std::array<std::uint8_t, 16> kDimensionOfSlot{0, 1, 2, 3,   // pixel, lens
                                                               2, 3, 0, 1,   // lobe, side, direction
                                                               3, 2, 0, 1,   // kind, light, place on it
                                                               2, 0, 1, 3};  // roulette, environment

}  // namespace sobol

/// Samples 16 j .. 16 j + 15 continue the sequence of replicate j mod 4: the replicates of the film.
constexpr SequencePlace sequence_place(std::uint64_t sample) {
  const std::uint64_t index = ((sample >> 6) << 4) | (sample & 15U);
  const std::uint64_t reversed_index = sobol::reversed(static_cast<std::uint32_t>(index));
  return {((sample >> 4) & 3U) | ((index >> 32) << 2), {(std::uint64_t{1} << 32) | reversed_index}};
}

/// Uniform in [0, 1), a multiple of 2^-53: the number of `slot` at a vertex with the key (a, b). The first
/// 32 digits are those of the scrambled point, the others a hash of them.
[[nodiscard]] double sobol_number(std::uint64_t a, std::uint64_t b, SequencePoint point,
                                  std::uint32_t slot);

}  // namespace raykiln::render
