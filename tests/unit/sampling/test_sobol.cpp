#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <numbers>
#include <set>
#include <vector>

#include "raykiln/image/film.hpp"
#include "raykiln/sampling/random.hpp"
#include "support/statistics.hpp"

namespace raykiln::render {
namespace {

double number(std::uint64_t pixel, std::uint64_t sample, Dimension dimension, std::uint64_t bounce = 1) {
  return uniform(vertex_key(path_key(Sampler::kSobol, 5, pixel, sample), 0, bounce), dimension);
}

std::size_t cell(double u, unsigned bits) {
  return static_cast<std::size_t>(std::ldexp(u, static_cast<int>(bits)));
}

// First points as multiples of 1/8: dimensions 1 and 2 of Sobol' (Joe & Kuo 2008); the third worked out by hand from powers of a
// root of x^2 + x + 1, the fourth from the third as the second from the first.
TEST(Sobol, KnownFirstPoints) {
  constexpr unsigned kEighths[4][8] = {{0, 4, 2, 6, 1, 5, 3, 7},
                                       {0, 4, 6, 2, 5, 1, 3, 7},
                                       {0, 4, 2, 6, 3, 7, 1, 5},
                                       {0, 4, 6, 2, 3, 7, 5, 1}};
  for (unsigned d = 0; d < 4; ++d) {
    for (std::uint32_t i = 0; i < 8; ++i) {
      EXPECT_EQ(sobol::reversed(sobol::coordinate(i, d)) >> 29, kEighths[d][i]) << d << ' ' << i;
    }
  }
}

TEST(Sobol, ScramblingIsNested) {
  // Words that agree in their first k digits (lowest bits) agree there afterwards, and differ in digit k.
  for (unsigned k = 0; k < 32; ++k) {
    for (std::uint32_t seed = 1; seed < 200; ++seed) {
      const std::uint32_t x = seed * 0x9E3779B9U, y = x ^ (1U << k);
      const std::uint32_t differ = sobol::scrambled(x, seed * 77777U) ^ sobol::scrambled(y, seed * 77777U);
      EXPECT_EQ(std::countr_zero(differ), static_cast<int>(k));
    }
  }
}

TEST(Sobol, SamplesBelongToTheReplicatesOfTheFilm) {
  std::set<std::pair<std::uint64_t, std::uint64_t>> places;
  std::vector<std::uint32_t> next(kReplicates, 0);
  for (const SampleBlock& block : blocks_for(1024)) {
    for (std::uint64_t s = block.first; s < block.first + block.count; ++s) {
      const SequencePlace place = sequence_place(s);
      ASSERT_EQ(place.sequence, replicate_of(block.index)) << s;
      ASSERT_EQ(sobol::reversed(place.point.reversed_index()), next[place.sequence]++) << s;
    }
  }
  for (const std::uint32_t count : next) EXPECT_EQ(count, 256U);
}

// 2^k samples of a replicate from a multiple of 2^k on: one in each interval of length 2^-k of every number,
// and one in each elementary rectangle of the pairs that lie in the first or the last two dimensions.
TEST(Sobol, EveryAlignedRunFillsSpace) {
  constexpr unsigned kBits = 4;
  const std::vector<std::pair<Dimension, Dimension>> pairs{{Dimension::kPixelX, Dimension::kPixelY},
                                                           {Dimension::kLensX, Dimension::kLensY},
                                                           {Dimension::kLobeChoice, Dimension::kFresnelChoice},
                                                           {Dimension::kDirectionU, Dimension::kDirectionV},
                                                           {Dimension::kLightU, Dimension::kLightV},
                                                           {Dimension::kEnvironmentU, Dimension::kEnvironmentV}};
  for (std::uint64_t block = 0; block < 40; ++block) {
    for (std::uint32_t d = 0; d < 16; ++d) {
      unsigned seen = 0;
      for (std::uint64_t i = 0; i < 16; ++i) {
        seen |= 1U << cell(number(block, 16 * block + i, static_cast<Dimension>(d)), kBits);
      }
      EXPECT_EQ(seen, 0xFFFFU) << block << ' ' << d;
    }
    for (const auto& [u, v] : pairs) {
      for (unsigned k = 0; k <= kBits; ++k) {
        unsigned seen = 0;
        for (std::uint64_t i = 0; i < 16; ++i) {
          const std::size_t x = cell(number(3, 16 * block + i, u), k), y = cell(number(3, 16 * block + i, v), kBits - k);
          seen |= 1U << ((y << k) | x);
        }
        EXPECT_EQ(seen, 0xFFFFU) << block << ' ' << k;
      }
    }
  }
}

// 16 samples of a replicate fill the 4 x 4 squares of any two numbers of a group, 64 the 4 x 4 x 4 cubes of any three.
TEST(Sobol, NumbersOfAGroupFillSpaceTogether) {
  struct Group {
    std::uint64_t bounce;
    Dimension of[4];
  };
  const Group groups[] = {
      {0, {Dimension::kDirectionU, Dimension::kDirectionV, Dimension::kPixelX, Dimension::kPixelY}},
      {0, {Dimension::kLensX, Dimension::kLensY, Dimension::kLobeChoice, Dimension::kFresnelChoice}},
      {3, {Dimension::kDirectionU, Dimension::kDirectionV, Dimension::kLobeChoice, Dimension::kFresnelChoice}},
      {1, {Dimension::kLightU, Dimension::kLightV, Dimension::kLightChoice, Dimension::kLightKindChoice}},
      {2, {Dimension::kEnvironmentU, Dimension::kEnvironmentV, Dimension::kRoulette, Dimension::kCoverage}}};
  const auto sample_of = [](std::uint64_t replicate, std::uint64_t i) { return 64 * (i / 16) + 16 * replicate + i % 16; };
  for (const Group& group : groups) {
    for (std::uint64_t run = 0; run < 16; ++run) {
      const std::uint64_t replicate = run % 4, first = 64 * (run / 4);
      for (unsigned left_out = 0; left_out < 4; ++left_out) {
        std::set<std::size_t> cubes, squares;
        for (std::uint64_t i = 0; i < 64; ++i) {
          std::size_t cube = 0, square = 0;
          for (unsigned k = 0; k < 4; ++k) {
            const std::size_t at = cell(number(7, sample_of(replicate, first + i), group.of[k], group.bounce), 2);
            if (k != left_out) cube = 4 * cube + at;
            if (k != left_out && k != (left_out + 1) % 4) square = 4 * square + at;
          }
          cubes.insert(cube);
          squares.insert(16 * (i / 16) + square);
        }
        EXPECT_EQ(cubes.size(), 64U);
        EXPECT_EQ(squares.size(), 64U);
      }
    }
  }
}

// Single numbers of many pixels are uniform to the last digits, and numbers of other groups, bounces, pixels
// and replicates are not correlated. False alarm 0.01 + 5 * 6.3e-5.
TEST(Sobol, RandomisedUniformlyAndApart) {
  constexpr std::uint64_t kCount = 100000;
  std::vector<double> high(256, 0.0), low(256, 0.0);
  double sums[5] = {};
  for (std::uint64_t pixel = 0; pixel < kCount; ++pixel) {
    const double u = number(pixel, 3, Dimension::kDirectionU);
    high[cell(u, 8)] += 1.0;
    low[cell(std::ldexp(u, 45) - std::floor(std::ldexp(u, 45)), 8)] += 1.0;
    const double others[5] = {number(pixel, 3, Dimension::kLightU), number(pixel, 3, Dimension::kDirectionU, 2),
                              number(pixel + 1, 3, Dimension::kDirectionU), number(pixel, 19, Dimension::kDirectionU),
                              number(pixel, 3, Dimension::kDirectionV)};
    for (int k = 0; k < 5; ++k) sums[k] += 12.0 * (u - 0.5) * (others[k] - 0.5);
  }
  const std::vector<double> expected(256, static_cast<double>(kCount) / 256);
  EXPECT_GT(support::chi_square_p(high, expected), support::sidak_level(2));
  EXPECT_GT(support::chi_square_p(low, expected), support::sidak_level(2));
  for (const double sum : sums) EXPECT_LT(std::abs(sum), 4.0 * std::sqrt(static_cast<double>(kCount)));
}

TEST(Sobol, IndicesBeyondThirtyTwoBitsAreOtherSequences) {
  for (std::uint64_t i = 0; i < 64; ++i) {
    const std::uint64_t far = (std::uint64_t{1} << 35) + i;
    EXPECT_EQ(sequence_place(far).point.word, sequence_place(i).point.word);
    EXPECT_NE(sequence_place(far).sequence, sequence_place(i).sequence);
    EXPECT_NE(number(1, far, Dimension::kPixelX), number(1, i, Dimension::kPixelX));
  }
}

/// Slope of log MSE over log n for n = 128 .. 2048, and the MSE at the end.
template <typename Integrand>
std::pair<double, double> slope_of(Sampler sampler, Integrand f, double truth) {
  std::vector<double> x, y;
  for (std::uint64_t n = 128; n <= 2048; n *= 2) {
    double mse = 0.0;
    for (std::uint64_t pixel = 0; pixel < 100; ++pixel) {
      double sum = 0.0;
      for (std::uint64_t i = 0; i < n; ++i) {
        const VertexKey key = vertex_key(path_key(sampler, 9, pixel, i), 0, 0);
        sum += f(uniform(key, Dimension::kLightU), uniform(key, Dimension::kLightV));
      }
      const double error = sum / static_cast<double>(n) - truth;
      mse += error * error / 100.0;
    }
    x.push_back(std::log2(static_cast<double>(n)));
    y.push_back(std::log2(mse));
  }
  double sxy = 0.0, sxx = 0.0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    sxy += (x[k] - 9.0) * y[k];
    sxx += (x[k] - 9.0) * (x[k] - 9.0);
  }
  return {sxy / sxx, std::exp2(y.back())};
}

// Owen 1997: n^-3 for smooth integrands; n^-1.5 where an edge crosses the square. The fit scatters by 0.1.
TEST(Sobol, ErrorsFallFasterThanOfIndependentNumbers) {
  const auto smooth = [](double x, double y) { return std::exp(-x * x - y * y); };
  const double half = std::sqrt(std::numbers::pi) / 2.0 * std::erf(1.0), truth = half * half;
  const auto edge = [](double x, double y) { return x + 2.0 * y < 1.3 ? 1.0 : 0.0; };
  EXPECT_NEAR(slope_of(Sampler::kRandom, smooth, truth).first, -1.0, 0.2);
  EXPECT_NEAR(slope_of(Sampler::kSobol, smooth, truth).first, -2.9, 0.3);
  EXPECT_NEAR(slope_of(Sampler::kSobol, edge, 0.4).first, -1.5, 0.2);
  EXPECT_LT(slope_of(Sampler::kSobol, edge, 0.4).second, 0.1 * slope_of(Sampler::kRandom, edge, 0.4).second);
}

}  // namespace
}  // namespace raykiln::render
