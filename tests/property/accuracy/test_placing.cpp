// What a plan for further samples costs and saves where the true noise of the cells is known: the sum of n times the sum of V/n over that
// of even samples.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "raykiln/accuracy/allocation.hpp"
#include "support/synthetic_film.hpp"

namespace raykiln::render {
namespace {

using support::synthetic_film;
using support::TestRandom;

constexpr int kAcross = 8;
constexpr double kMean = 1024.0;

/// Time to equal error by `plan` over that of even samples; below 1 the plan gains.
double cost(const std::vector<std::uint64_t>& plan, const std::vector<double>& truth) {
  double spent = 0.0, left = 0.0, all = 0.0;
  for (std::size_t i = 0; i < plan.size(); ++i) {
    spent += static_cast<double>(plan[i]);
    left += truth[i] / static_cast<double>(plan[i]);
    all += truth[i];
  }
  return spent * left / (static_cast<double>(plan.size()) * all);
}

/// The least cost there is: n in proportion to sqrt(V).
double least_cost(const std::vector<double>& truth) {
  double roots = 0.0, all = 0.0;
  for (const double v : truth) {
    roots += std::sqrt(v);
    all += v;
  }
  return roots * roots / (static_cast<double>(truth.size()) * all);
}

/// V of a cell from samples that are mostly tame, and of which `events` on average are rare and large (their squares have infinite variance);
/// with the scatter that they show: an event adds its square.
CellNoise seen(TestRandom& random, double tame, double events, double of_event) {
  CellNoise cell{.pixels = 256.0, .samples = 64.0, .noise = tame * (1.0 + 0.05 * random.normal()), .scatter = 0.0025 * tame * tame};
  for (double at = random.exponential(); at < events; at += random.exponential()) {
    const double square = of_event / std::pow(random.uniform(), 1.0 / 1.5);  // P(square > x) falls like x^-1.5
    cell.noise += square;
    cell.scatter += square * square;
  }
  return cell;
}

TEST(Placing, CostsLittleWhereCellsDifferByRareEventsAlone) {
  for (const double events : {0.2, 1.0, 4.0}) {
    double mean = 0.0, trusting = 0.0, worst = 0.0;
    constexpr int kDraws = 200;
    for (std::uint64_t seed = 0; seed < kDraws; ++seed) {
      TestRandom random(seed);
      std::vector<CellNoise> cells;
      for (int i = 0; i < 5 * kAcross; ++i) cells.push_back(seen(random, 1.0, events, 2.0));
      const std::vector<double> truth(cells.size(), 1.0);
      const double found = cost(place_samples(cells, kAcross, kMean, 1U << 20U), truth);
      mean += found / kDraws;
      worst = std::max(worst, found);
      for (CellNoise& cell : cells) cell.scatter = 0.0;
      trusting += cost(place_samples(cells, kAcross, kMean, 1U << 20U), truth) / kDraws;
    }
    RecordProperty("events " + std::to_string(events), std::to_string(mean) + " trusting " + std::to_string(trusting) + " worst " + std::to_string(worst));
    EXPECT_LT(mean, 1.05) << events;
    EXPECT_LT(worst, 1.25) << events;
    EXPECT_GT(trusting, mean) << events << ": the hazard is there";
  }
}

TEST(Placing, GainsWhatThereIsToGainWhereNoiseIsKnown) {
  for (const double noisy : {4.0, 16.0, 100.0}) {
    double mean = 0.0, least = 0.0;
    constexpr int kDraws = 100;
    for (std::uint64_t seed = 0; seed < kDraws; ++seed) {
      TestRandom random(seed);
      std::vector<CellNoise> cells;
      std::vector<double> truth;
      for (int i = 0; i < 5 * kAcross; ++i) {
        truth.push_back(i % kAcross < 3 ? noisy : 1.0);
        cells.push_back(seen(random, truth.back(), 0.0, 0.0));
      }
      mean += cost(place_samples(cells, kAcross, kMean, 1U << 20U), truth) / kDraws;
      least += least_cost(truth) / kDraws;
    }
    RecordProperty("noisy " + std::to_string(noisy), std::to_string(mean) + " least " + std::to_string(least));
    EXPECT_LT(mean, 1.06 * least + 0.02) << noisy;
  }
}

// The share that is spent evenly is the least that any cell gets, however wrong the estimates: it bounds what they can cost.
TEST(Placing, IsBoundedByItsEvenShare) {
  TestRandom random(3);
  for (int draw = 0; draw < 300; ++draw) {
    std::vector<CellNoise> cells;
    double mean = 0.0, squares = 0.0, noise = 0.0;
    constexpr int kCells = 5 * kAcross;
    for (int i = 0; i < kCells; ++i) {
      CellNoise cell{.pixels = 256.0, .samples = 0.0, .noise = std::exp(2.0 * random.normal())};
      cell.scatter = 2.0 * cell.noise * cell.noise * random.uniform();
      cells.push_back(cell);
      mean += std::sqrt(cell.noise) / kCells;
      squares += cell.noise / kCells;
      noise += cell.scatter / (4.0 * cell.noise) / kCells;
    }
    const double even = std::min(1.0, noise / ((squares - mean * mean) * kCells / (kCells - 1.0)));
    const auto plan = place_samples(cells, kAcross, kMean, 1U << 20U);
    const double sum = static_cast<double>(std::accumulate(plan.begin(), plan.end(), std::uint64_t{0}));
    EXPECT_NEAR(sum / kCells, kMean, 1.0);
    EXPECT_GE(static_cast<double>(*std::min_element(plan.begin(), plan.end())), 0.999 * std::max(even, kLeastShareOfSamples) * kMean);
    // Noise larger than the differences: even.
    for (CellNoise& cell : cells) cell.scatter = 1e6 * cell.noise * cell.noise;
    for (const std::uint64_t n : place_samples(cells, kAcross, kMean, 1U << 20U)) EXPECT_NEAR(static_cast<double>(n), kMean, 1.0);
  }
}

// From films, as jobs have it: all cells alike, 64 samples, of which one in 30000 (half an event a cell) is bright.
TEST(Placing, OfFilmsWithFirefliesIsNearlyEven) {
  double mean = 0.0;
  constexpr int kFilms = 12;
  for (std::uint64_t seed = 0; seed < kFilms; ++seed) {
    const Film film = synthetic_film(64, 64, 64, seed, [](int, int, TestRandom& random) {
      return Rgbd(random.exponential() + (random.uniform() < 1.0 / 30000.0 ? 100.0 / std::sqrt(random.uniform()) : 0.0));
    });
    mean += cost(allocate_samples(film, kMean, 1U << 20U), std::vector<double>(16, 1.0)) / kFilms;
  }
  RecordProperty("cost", std::to_string(mean));
  EXPECT_LT(mean, 1.05);
}

// Lamps beside dark ground, with relative noise alike everywhere: an edge is no noise.
TEST(Placing, OfEdgesAsNoisyAsTheRestIsEven) {
  const Film film = synthetic_film(64, 64, 64, 1, [](int x, int y, TestRandom& random) {
    const bool lamp = x < 32 && x % 5 == 0 && y % 5 == 0;
    return Rgbd((lamp ? 100.0 : 1.0) * (1.0 + 0.3 * random.normal()));
  });
  const auto plan = allocate_samples(film, kMean, 1U << 20U);
  EXPECT_LT(cost(plan, std::vector<double>(plan.size(), 1.0)), 1.02);
}

}  // namespace
}  // namespace raykiln::render
