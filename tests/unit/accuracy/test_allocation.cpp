#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "raykiln/accuracy/allocation.hpp"
#include "support/synthetic_film.hpp"

namespace raykiln::render {
namespace {

using support::synthetic_film;
using support::TestRandom;

TEST(Allocation, CellsCoverTheSideAndNoMore) {
  EXPECT_EQ(cells_across(1), 1);
  EXPECT_EQ(cells_across(kCellSide), 1);
  EXPECT_EQ(cells_across(kCellSide + 1), 2);
  const Film film(2 * kCellSide + 1, kCellSide);
  EXPECT_EQ(cell_noise(film).size(), static_cast<std::size_t>(cells_across(film.width()) * cells_across(film.height())));
}

TEST(Allocation, FollowsTheSquareRootOfTheNoise) {
  // Four cells in a row, and a fifth with 64 times their variance.
  const Film film = synthetic_film(80, 16, 64, 1, [](int x, int, TestRandom& random) {
    return Rgbd(1.0 + (x >= 64 ? 0.64 : 0.08) * random.normal());
  });
  const auto samples = allocate_samples(film, 640.0, 100000);
  ASSERT_EQ(samples.size(), 5U);
  // n = f 1 for three cells, f 2 for the neighbour of the noisy one (a quarter of its wish), f 8 for the noisy one: 3200 / 13.
  EXPECT_NEAR(static_cast<double>(samples[0]), 3200.0 / 13.0, 12.0);
  EXPECT_NEAR(static_cast<double>(samples[3]), 6400.0 / 13.0, 25.0);
  EXPECT_NEAR(static_cast<double>(samples[4]), 25600.0 / 13.0, 100.0);
  const std::uint64_t all = std::accumulate(samples.begin(), samples.end(), std::uint64_t{0});
  EXPECT_NEAR(static_cast<double>(all), 5 * 640.0, 5.0);
}

TEST(Allocation, EveryCellKeepsItsShareAndNoneExceedsTheMost) {
  const Film film = synthetic_film(64, 16, 64, 1, [](int x, int, TestRandom& random) {
    return Rgbd(x < 16 ? 1.0 + random.normal() : 1.0);  // no noise elsewhere
  });
  const auto samples = allocate_samples(film, 256.0, 512);
  EXPECT_EQ(samples[0], 512U);
  EXPECT_EQ(samples[3], 64U);  // a quarter of 256
  for (const std::uint64_t n : allocate_samples(film, 10.0, 512)) EXPECT_EQ(n, 64U);  // none loses what it has
}

TEST(Allocation, IsEvenWithoutAnyEstimateOrNoise) {
  for (const std::uint64_t n : allocate_samples(Film(40, 20), 100.0, 1000)) EXPECT_EQ(n, 100U);
  const Film still = synthetic_film(32, 16, 64, 1, [](int, int, auto&) { return Rgbd(1.0); });
  for (const std::uint64_t n : allocate_samples(still, 400.0, 1000)) EXPECT_EQ(n, 100U);
}

TEST(Allocation, IsAFunctionOfTheFilmAlone) {
  const auto film = [] {
    return synthetic_film(50, 34, 64, 5, [](int x, int y, TestRandom& random) { return Rgbd(random.uniform() * (x + y)); });
  };
  EXPECT_EQ(allocate_samples(film(), 100.0, 4096), allocate_samples(film(), 100.0, 4096));
}

}  // namespace
}  // namespace raykiln::render
