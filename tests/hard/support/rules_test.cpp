// The rules themselves: each must accept what is right and reject what is planted.
#include "hard/support/rules.hpp"

#include <gtest/gtest.h>

#include "support/mesh_generators.hpp"
#include "support/statistics.hpp"

namespace raykiln::hard {
namespace {

using test::TestRandom;

Samples uniform_samples(std::uint64_t n, std::uint64_t seed, double shift = 0.0) {
  TestRandom random(seed);
  Samples samples;
  for (std::uint64_t i = 0; i < n; ++i) {
    samples.add(static_cast<double>(random.uniform()) + shift);
  }
  return samples;
}

TEST(RuleR2, AcceptsTheTruthAndRejectsAShiftOfSixSigma) {
  const Samples samples = uniform_samples(100000, 7);
  EXPECT_NEAR(samples.standard_error(), std::sqrt(1.0 / 12.0 / 1e5), 1e-5);
  EXPECT_EQ(within_four_sigma(samples, 0.5), Verdict::kAccepted);
  const double shift = 6.0 * samples.standard_error();
  const Samples shifted = uniform_samples(100000, 7, shift);
  EXPECT_EQ(within_four_sigma(shifted, 0.5 - shift), Verdict::kRejected);
  EXPECT_EQ(within_four_sigma(shifted, 0.5 - shift, 3.0 * shift), Verdict::kAccepted);
}

TEST(RuleR2, FewContributionsDecideNothing) {
  Samples samples;
  for (int i = 0; i < 100000; ++i) samples.add(i % 4000 == 0 ? 4000.0 : 0.0);
  EXPECT_EQ(samples.non_zero, 25U);
  EXPECT_EQ(within_four_sigma(samples, 1.0), Verdict::kInconclusive);
  EXPECT_EQ(Samples{}.standard_error(), kInfinite);
}

TEST(RuleR2, FalseAlarmsAreRare) {
  int rejected = 0;
  for (std::uint64_t seed = 1; seed <= 1000; ++seed) {
    rejected += within_four_sigma(uniform_samples(1000, seed), 0.5) == Verdict::kRejected ? 1 : 0;
  }
  EXPECT_LE(rejected, 2);  // 0.06 expected
}

TEST(RuleR3, RuleOfThree) { EXPECT_DOUBLE_EQ(rate_bound(1000000), 3e-6); }

TEST(RuleR4, ChiSquareAcceptsTheDensityAndRejectsOneWithoutItsWeight) {
  TestRandom random(4);
  std::vector<double> seen(1000, 0.0), expected(1000, 0.0), planted(1000, 0.0);
  constexpr double kN = 1e6;
  for (int i = 0; i < 1'000'000; ++i) {  // density 2 x on [0, 1): the last cells of 1000 are fullest
    seen[static_cast<std::size_t>(1000.0 * std::sqrt(static_cast<double>(random.uniform())))] += 1.0;
  }
  for (std::size_t i = 0; i < 1000; ++i) {
    const double x = (static_cast<double>(i) + 0.5) / 1000.0;
    expected[i] = kN * 2.0 * x / 1000.0;
    planted[i] = kN * (0.99 * 2.0 * x + 0.01) / 1000.0;
  }
  const double level = render::support::sidak_level(100.0);
  EXPECT_NEAR(level, 1.005e-4, 1e-6);
  EXPECT_GT(render::support::chi_square_p(seen, expected), level);
  EXPECT_LT(render::support::chi_square_p(seen, planted), level);
}

TEST(RuleR5, SidakBand) {
  EXPECT_NEAR(sidak_z(1.0), 2.5758, 1e-3);
  EXPECT_NEAR(sidak_z(4096.0), 4.7104, 2e-2);
}

std::vector<PixelEstimate> noisy_image(std::uint64_t seed, double bias) {
  TestRandom random(seed);
  std::vector<PixelEstimate> image(4096);
  for (PixelEstimate& pixel : image) {  // mean of 12 uniforms: variance 1/144
    double sum = 0.0;
    for (int i = 0; i < 12; ++i) sum += static_cast<double>(random.uniform());
    pixel = {sum / 12.0 + bias, 1.0 / 144.0};
  }
  return image;
}

TEST(RuleR5, AcceptsEqualImagesRejectsASmallUniformBias) {
  EXPECT_TRUE(compare_images(noisy_image(1, 0.0), noisy_image(2, 0.0)).equal());
  const auto biased = compare_images(noisy_image(1, 0.0), noisy_image(2, 0.02));
  EXPECT_GE(biased.accepted_share, 0.9975);  // no pixel shows it
  EXPECT_FALSE(biased.equal());
  auto spots = noisy_image(2, 0.0);
  for (std::size_t i = 0; i < 20; ++i) spots[i * 200].mean += i % 2 == 0 ? 1.5 : -1.5;
  EXPECT_FALSE(compare_images(noisy_image(1, 0.0), spots).equal());
}

TEST(RuleR5, WithoutVarianceOnlyRoundingMayDiffer) {
  const std::vector<PixelEstimate> one{{1.0, 0.0}};
  const std::vector<PixelEstimate> near{{1.0 + 2.0 * kUnit, 0.0}};
  const std::vector<PixelEstimate> off{{1.0 + 20.0 * kUnit, 0.0}};
  EXPECT_TRUE(compare_images(one, near).equal());
  EXPECT_FALSE(compare_images(one, off).equal());
}

TEST(RuleR6, EveryBitCounts) {
  const std::vector<std::vector<double>> a{{1.0, 0.0}, {2.0}};
  const std::vector<std::vector<double>> b{{1.0, -0.0}, {2.0}};
  const std::vector<std::vector<double>> c{{1.0, 0.0}, {std::nextafter(2.0, 3.0)}};
  EXPECT_EQ(bit_hash(a), bit_hash(a));
  EXPECT_NE(bit_hash(a), bit_hash(b));
  EXPECT_NE(bit_hash(a), bit_hash(c));
}

}  // namespace
}  // namespace raykiln::hard
