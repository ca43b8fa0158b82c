#include <gtest/gtest.h>

#include <cmath>

#include "raykiln/sampling/discrete_distribution.hpp"

namespace raykiln::render {
namespace {

TEST(DiscreteDistribution, DrawsInProportionAndNeverAZero) {
  const std::vector<double> weights{0.0, 1.0, 0.0, 0.0, 3.0, 4.0, 0.0};
  const DiscreteDistribution distribution(weights);
  std::vector<double> seen(weights.size(), 0.0);
  constexpr int kCount = 80000;
  for (int i = 0; i < kCount; ++i) seen[distribution.sample((i + 0.5) / kCount)] += 1.0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    EXPECT_NEAR(seen[i] / kCount, weights[i] / 8.0, 2.0 / kCount);
    EXPECT_DOUBLE_EQ(distribution.probability(i), weights[i] / 8.0);
  }
  EXPECT_EQ(distribution.sample(0.0), 1U);
  EXPECT_EQ(distribution.sample(1.0 - 0x1p-53), 5U);
}

TEST(DiscreteDistribution, EmptyWhenNothingHasWeight) {
  EXPECT_TRUE(DiscreteDistribution().empty());
  EXPECT_TRUE(DiscreteDistribution(std::vector<double>{0.0, 0.0}).empty());
}

TEST(DiscreteDistribution, ScalingByAPowerOfTwoChangesNoDraw) {
  const std::vector<double> weights{0.1, 0.7, 1e-12, 0.3};
  std::vector<double> scaled = weights;
  for (double& w : scaled) w = std::ldexp(w, -70);
  const DiscreteDistribution a(weights), b(scaled);
  for (int i = 0; i < 10000; ++i) EXPECT_EQ(a.sample(i / 1e4), b.sample(i / 1e4));
}

}  // namespace
}  // namespace raykiln::render
