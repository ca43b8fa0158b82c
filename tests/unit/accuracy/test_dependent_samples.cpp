// Pictures whose samples depend on each other within a replicate.
#include <gtest/gtest.h>

#include <cmath>

#include "raykiln/accuracy/image_error.hpp"
#include "raykiln/accuracy/pixel_error.hpp"
#include "support/synthetic_film.hpp"

namespace raykiln::render {
namespace {

using support::TestRandom;

/// Samples of a replicate are all the same: `value(replicate)`.
template <typename Value>
Film film_of_replicates(int side, std::uint64_t samples, Value value) {
  Film film(side, side, SampleRelation::kByReplicates);
  for (const SampleBlock& block : blocks_for(samples)) {
    const auto pixels = static_cast<std::size_t>(side * side);
    BlockResult result{.block = block, .planes = make_block_planes(pixels)};
    for (std::size_t p = 0; p < pixels; ++p) {
      for (std::uint64_t i = 0; i < block.count; ++i) {
        add_sample(result.planes, p, value(p, replicate_of(block.index)), false);
      }
    }
    film.fold({0, 0, side, side}, result);
  }
  return film;
}

TEST(DependentSamples, EqualReplicatesGiveTheTextbookFormula) {
  // Means 0 .. 3: sum of squared deviations 5, variance of their mean 5 / (4 * 3).
  const Film film = film_of_replicates(1, 1024, [](std::size_t, std::size_t r) {
    return Rgbd(static_cast<double>(r), 2.0 * static_cast<double>(r), 1.0);
  });
  const PixelErrors errors = pixel_errors(film);
  EXPECT_NEAR(errors.standard_error[0], std::sqrt(5.0 / 12.0), 1e-12);
  EXPECT_NEAR(errors.standard_error[1], 2.0 * std::sqrt(5.0 / 12.0), 1e-12);
  EXPECT_EQ(errors.standard_error[2], 0.0);
}

TEST(DependentSamples, NothingIsKnownBeforeThreeReplicates) {
  const auto varied = [](std::size_t, std::size_t r) { return Rgbd(1.0 + static_cast<double>(r)); };
  for (const std::uint64_t samples : {2, 16, 17, 32}) {
    const Film film = film_of_replicates(2, samples, varied);
    EXPECT_EQ(image_error(film).grade, ErrorGrade::kUnknown) << samples;
    EXPECT_TRUE(std::isnan(pixel_errors(film).standard_error[0])) << samples;
  }
  EXPECT_EQ(image_error(film_of_replicates(2, 33, varied)).grade, ErrorGrade::kRough);
  EXPECT_EQ(image_error(film_of_replicates(2, 64, varied)).grade, ErrorGrade::kMeasured);
}

// Whatever the sizes of replicates, and however little their variances have to do with them: 20000 pixels, so
// the mean of the estimates scatters by sqrt(2 / dof / 20000), 1 % for one degree of freedom; 4 sigma.
TEST(DependentSamples, VarianceIsUnbiasedForAnyNumberOfSamples) {
  constexpr int kSide = 142;
  for (const std::uint64_t samples : {40, 64, 100, 128, 136, 250}) {
    TestRandom random(samples);
    std::vector<std::vector<double>> of(static_cast<std::size_t>(kSide * kSide), std::vector<double>(kReplicates));
    for (auto& pixel : of) {
      for (std::size_t r = 0; r < kReplicates; ++r) pixel[r] = 5.0 + (r % 2 == 0 ? 1.0 : 0.5) * random.normal();
    }
    const Film film =
        film_of_replicates(kSide, samples, [&](std::size_t p, std::size_t r) { return Rgbd(of[p][r]); });
    double truth = 0.0, shown = 0.0;
    const PixelSums one = film.pixel(0);
    for (std::size_t r = 0; r < kReplicates; ++r) {
      const double share = one.luminance_count[r] / static_cast<double>(samples);
      truth += share * share * (r % 2 == 0 ? 1.0 : 0.25);
    }
    // Pooling over 3 x 3 pixels keeps the mean of the variances but at the borders.
    for (const double e : pixel_errors(film).standard_error) shown += e * e / (3.0 * kSide * kSide);
    EXPECT_NEAR(shown / truth, 1.0, samples < 64 ? 0.06 : 0.04) << samples;
  }
}

TEST(DependentSamples, TheErrorIsThatOfReplicatesAndNotOfSamples) {
  TestRandom random(3);
  std::vector<double> noise(32 * 32 * kReplicates);
  for (double& x : noise) x = 1.0 + 0.1 * random.normal();
  const Film film = film_of_replicates(32, 1024, [&](std::size_t p, std::size_t r) { return Rgbd(noise[kReplicates * p + r]); });
  const ImageError error = image_error(film);
  EXPECT_NEAR(error.error.value, 0.1 / std::sqrt(4.0) / std::sqrt(1.01), 0.003);
  EXPECT_FALSE(error.heavy_tailed);
}

}  // namespace
}  // namespace raykiln::render
