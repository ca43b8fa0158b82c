// Pictures whose variance the samples do not show: flagged, and only those.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "raykiln/accuracy/image_error.hpp"
#include "support/synthetic_film.hpp"

namespace raykiln::render {
namespace {

using support::synthetic_film;
using support::TestRandom;

/// Seeds of 100 whose picture is flagged.
int flagged(std::uint64_t samples, const std::function<double(TestRandom&)>& sample) {
  int count = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const Film film = synthetic_film(16, 16, samples, seed, [&](int, int, TestRandom& random) {
      return Rgbd(sample(random));
    });
    count += image_error(film).heavy_tailed ? 1 : 0;
  }
  return count;
}

// Weights cos_i / cos_o of a lobe divided by cos_o: P(weight > w) falls like w^-2.
double over_cosine(TestRandom& random) {
  const double cos_i = std::sqrt(random.uniform()), cos_o = std::sqrt(random.uniform());
  return cos_i / cos_o;
}
double over_larger_cosine(TestRandom& random) {
  const double cos_i = std::sqrt(random.uniform()), cos_o = std::sqrt(random.uniform());
  return cos_i / std::max(cos_i, cos_o);
}
/// 1 + B / p * 0.5 with B Bernoulli(p).
std::function<double(TestRandom&)> rare(double p) {
  return [p](TestRandom& random) { return 1.0 + (random.uniform() < p ? 0.5 / p : 0.0); };
}

TEST(Tails, OfInfiniteVarianceAreFlagged) {
  for (const std::uint64_t samples : {64U, 256U, 1024U}) {
    EXPECT_GE(flagged(samples, over_cosine), 95) << samples;
  }
}

TEST(Tails, OfRareLightAreFlaggedWhileItIsRare) {
  for (const std::uint64_t samples : {64U, 256U}) {
    EXPECT_GE(flagged(samples, rare(0.001)), 95) << samples;
  }
  EXPECT_GE(flagged(64, rare(0.01)), 95);
  EXPECT_EQ(flagged(1024, rare(0.02)), 0);  // 20 events a pixel
}

TEST(Tails, OfTameNoiseAreNot) {
  for (const std::uint64_t samples : {64U, 256U}) {
    EXPECT_EQ(flagged(samples, over_larger_cosine), 0) << samples;
    EXPECT_EQ(flagged(samples, [](TestRandom& random) { return random.exponential(); }), 0) << samples;
    EXPECT_EQ(flagged(samples, [](TestRandom& random) { return random.uniform(); }), 0) << samples;
  }
}

}  // namespace
}  // namespace raykiln::render
