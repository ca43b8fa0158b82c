// Owen-scrambled points of Sobol's kind as a pure function of keys: four dimensions at a time, padded.
//
// Burley 2020, "Practical hash-based Owen scrambling" (JCGT 9:4): each group of four dimensions uses the same
// four again, with the order of the points and each coordinate scrambled by hashes of its own.
// Groups are thereby independent of each other, and no table grows with the length of a path.
//
// The four are Niederreiter's sequence over the field of four elements (1988): 4^k points from a multiple of 4^k on have one in each
// box of 4^-a x 4^-b x 4^-c x 4^-d with a + b + c + d = k, so that 16 fill the squares of any two coordinates and 64 the cubes of any
// three. The first two are those of Sobol', and both they and the other two fill rectangles of all powers of 2 as well.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "raykiln/sampling/mix.hpp"

namespace raykiln::render {

/// A place in a sequence: its index with the first binary digit last, as scrambling wants it.
struct SequencePoint {
  /// Bit 32 is set for points of a sequence, bit 33 for those of a path's first vertex as well; the lower half is the index.
  std::uint64_t word = 0;
  [[nodiscard]] constexpr bool of_sequence() const { return word != 0; }
  [[nodiscard]] constexpr bool of_first_vertex() const { return (word >> 33) != 0; }
  [[nodiscard]] constexpr SequencePoint at_vertex(std::uint64_t bounce) const {
    return {bounce == 0 ? word | (word >> 32) << 33 : word};
  }
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

/// Columns of the generator matrix of the third dimension, joined for every value of four digits of the index.
struct Columns {
  std::array<std::array<std::uint32_t, 16>, 8> of_digits{};
};
extern const Columns kThird;

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

/// Coordinate `dimension` (0 .. 3) of point `index`, its first binary digit in the lowest bit.
constexpr std::uint32_t coordinate(std::uint32_t index, unsigned dimension) {
  const std::uint32_t first = dimension < 2 ? index : product(kThird, index);
  return dimension % 2 == 0 ? first : pascal_product(first);
}

/// Where a slot stands: its group at the vertex and the dimension there.
struct SlotPlace {
  std::uint8_t group, dimension;
};
/// Pairs that fill squares have the first or the last two dimensions, choices those that are left. What a ray does next is one point:
/// direction, lobe and side; at the first vertex, where alone a place in the pixel and in the lens are drawn, direction and place in the
/// pixel.
constexpr SlotPlace place_of(std::uint32_t slot, bool first_vertex) {
  constexpr std::array<SlotPlace, 16> kPlaces{{{0, 2}, {0, 3}, {1, 0}, {1, 1},     // pixel, lens
                                               {0, 2}, {0, 3}, {0, 0}, {0, 1},     // lobe, side, direction
                                               {2, 3}, {2, 2}, {2, 0}, {2, 1},     // kind of light, light, place on it
                                               {3, 2}, {3, 0}, {3, 1}, {3, 3}}};   // roulette, environment, coverage
  const SlotPlace place = kPlaces[slot & 15U];
  const bool gives_way = first_vertex && slot / 2 == 2;  // lobe and side
  return gives_way ? SlotPlace{1, place.dimension} : place;
}

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
