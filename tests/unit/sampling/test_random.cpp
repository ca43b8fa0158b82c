#include <gtest/gtest.h>

#include <bit>
#include <set>

#include "raykiln/sampling/random.hpp"
#include "support/statistics.hpp"

namespace raykiln::render {
namespace {

double number(std::uint64_t seed, std::uint64_t pixel, std::uint64_t sample, std::uint64_t node,
              std::uint64_t bounce, Dimension dimension) {
  return uniform(vertex_key(path_key(seed, pixel, sample), node, bounce), dimension);
}

/// One of the six inputs counts up, the others stand still.
double along(int input, std::uint64_t i) {
  return number(input == 0 ? i : 1, input == 1 ? i : 2, input == 2 ? i : 3, input == 3 ? i : 0,
                input == 4 ? i : 4,
                static_cast<Dimension>(input == 5 ? i % static_cast<std::uint64_t>(Dimension::kCount)
                                                  : 6));
}

TEST(Random, IsAPureFunctionOfItsKey) {
  EXPECT_EQ(number(1, 2, 3, 4, 5, Dimension::kLightU), number(1, 2, 3, 4, 5, Dimension::kLightU));
}

TEST(Random, StaysBelowOne) {
  for (std::uint64_t i = 0; i < 100000; ++i) {
    const double u = along(1, i);
    ASSERT_GE(u, 0.0);
    ASSERT_LT(u, 1.0);
  }
}

// 5 inputs, chi-square with 256 cells and the correlation of neighbours in each; together a false
// alarm of 0.01 + 5 * 6.3e-5. Also with a step of 2^32, where a pixel key changes its row.
TEST(Random, UniformAndUncorrelatedAlongEveryInput) {
  constexpr std::uint64_t kCount = 200000;
  constexpr int kCells = 256;
  for (int input = 0; input < 5; ++input) {
    for (const std::uint64_t step : {std::uint64_t{1}, std::uint64_t{1} << 32}) {
      std::vector<double> seen(kCells, 0.0);
      double covariance = 0.0, before = 0.0;
      for (std::uint64_t i = 0; i < kCount; ++i) {
        const double u = along(input, i * step);
        seen[static_cast<std::size_t>(u * kCells)] += 1.0;
        if (i > 0) covariance += (u - 0.5) * (before - 0.5);
        before = u;
      }
      const std::vector<double> expected(kCells, static_cast<double>(kCount) / kCells);
      EXPECT_GT(support::chi_square_p(seen, expected), support::sidak_level(10)) << input << step;
      const double correlation = 12.0 * covariance / static_cast<double>(kCount);
      EXPECT_LT(std::abs(correlation), 4.0 / std::sqrt(static_cast<double>(kCount))) << input << step;
    }
  }
}

// Pairs of dimensions of one vertex fill the unit square: 256 cells, 120 pairs, false alarm 0.01.
TEST(Random, DimensionsAreIndependentInPairs) {
  constexpr int kSide = 16, kCount = 20000;
  constexpr auto kDimensions = static_cast<std::uint32_t>(Dimension::kCount);
  for (std::uint32_t a = 0; a < kDimensions; ++a) {
    for (std::uint32_t b = a + 1; b < kDimensions; ++b) {
      std::vector<double> seen(kSide * kSide, 0.0);
      for (std::uint64_t i = 0; i < kCount; ++i) {
        const VertexKey key = vertex_key(path_key(7, i, 0), 0, 1);
        const auto x = static_cast<std::size_t>(uniform(key, static_cast<Dimension>(a)) * kSide);
        const auto y = static_cast<std::size_t>(uniform(key, static_cast<Dimension>(b)) * kSide);
        seen[kSide * y + x] += 1.0;
      }
      const std::vector<double> expected(seen.size(), kCount / 256.0);
      EXPECT_GT(support::chi_square_p(seen, expected), support::sidak_level(120)) << a << ' ' << b;
    }
  }
}

// Every bit of the key flips about half of the result: mean of 64 flips each over 256 keys has a
// standard deviation of 4 / 16; 6 sigma, about 400 checks.
TEST(Random, EveryInputBitReachesEveryOutput) {
  for (int input = 0; input < 5; ++input) {
    for (int bit = 0; bit < 64; ++bit) {
      double flips = 0.0;
      for (std::uint64_t i = 0; i < 256; ++i) {
        const std::uint64_t x = i * 0x123456789ABCDEFU, y = x ^ (std::uint64_t{1} << bit);
        const auto bits = [&](std::uint64_t v) {
          return random_bits(vertex_key(path_key(input == 0 ? v : 1, input == 1 ? v : 2,
                                                 input == 2 ? v : 3),
                                        input == 3 ? v : 4, input == 4 ? v : 5),
                             Dimension::kLightU);
        };
        flips += std::popcount(bits(x) ^ bits(y));
      }
      EXPECT_NEAR(flips / 256.0, 32.0, 6.0 * 4.0 / 16.0) << input << ' ' << bit;
    }
  }
}

TEST(Random, NoTwoKeysShareAStream) {
  std::set<std::uint64_t> seen;
  std::uint64_t drawn = 0;
  for (std::uint64_t pixel = 0; pixel < 100; ++pixel) {
    for (std::uint64_t sample = 0; sample < 100; ++sample) {
      for (const std::uint64_t far : {std::uint64_t{0}, std::uint64_t{1} << 32}) {
        for (std::uint64_t bounce = 0; bounce < 5; ++bounce) {
          seen.insert(random_bits(vertex_key(path_key(pixel, sample, far + pixel), 0, bounce),
                                  Dimension::kPixelX));
          ++drawn;
        }
      }
    }
  }
  EXPECT_EQ(seen.size(), drawn);
}

}  // namespace
}  // namespace raykiln::render
