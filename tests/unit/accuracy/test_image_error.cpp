#include <gtest/gtest.h>

#include <cmath>

#include "raykiln/accuracy/image_error.hpp"
#include "raykiln/accuracy/true_error.hpp"
#include "support/synthetic_film.hpp"

namespace raykiln::render {
namespace {

using support::synthetic_film;
using Notices = std::vector<std::string>;

TEST(ImageError, OfOnePixelFollowsTheDefinition) {
  int i = 0;
  const double values[] = {1, 3, 3, 5};
  const Film film = synthetic_film(1, 1, 4, 1, [&](int, int, auto&) { return Rgbd(values[i++]); });
  const ImageError error = image_error(film);
  const double variance = 8.0 / 12.0, expected = variance / (9.0 + 0.01 * 9.0);
  EXPECT_NEAR(error.rel_mse.value, expected, 1e-14);
  EXPECT_NEAR(error.error.value, std::sqrt(expected), 1e-14);
  EXPECT_NEAR(error.rmse.value, std::sqrt(variance), 1e-14);
  EXPECT_EQ(error.grade, ErrorGrade::kRough);
  EXPECT_EQ(error.least_samples, 4U);
  EXPECT_LT(error.error.low, error.error.value);
  EXPECT_GT(error.error.high, error.error.value);
  EXPECT_NEAR(error.error.high * error.error.low, expected, 1e-12);
}

TEST(ImageError, FewerThanTwoSamplesAreUnknownNotZero) {
  Film film(3, 1);
  EXPECT_EQ(name(image_error(film).grade), "unknown");
  BlockResult one{.block = sample_block(0), .planes = make_block_planes(3)};
  for (std::size_t i = 0; i < 3; ++i) add_sample(one.planes, i, Rgbd(0.5), false);
  film.fold({0, 0, 3, 1}, one);
  const ImageError error = image_error(film);
  EXPECT_EQ(error.grade, ErrorGrade::kUnknown);
  EXPECT_EQ(error.error.value, 0.0);
  EXPECT_EQ(error_notices(error, true), (Notices{"error_unknown"}));
  EXPECT_EQ(error_notices(error, false), (Notices{"error_unknown", "aliasing_not_measured"}));
}

TEST(ImageError, AnUnsampledTileMakesTheWholeUnknown) {
  Film film(2, 1);
  BlockResult block{.block = sample_block(4), .planes = make_block_planes(1)};
  for (int i = 0; i < 8; ++i) add_sample(block.planes, 0, Rgbd(0.5 + i), false);
  film.fold({0, 0, 1, 1}, block);
  const ImageError error = image_error(film);
  EXPECT_EQ(error.unsampled_pixels, 1U);
  EXPECT_EQ(error_notices(error, true), (Notices{"unsampled_pixels", "error_unknown"}));
  EXPECT_TRUE(std::isfinite(error.mean_samples));
}

TEST(ImageError, APictureWithoutNoiseHasErrorZeroAndSaysThatNothingVaried) {
  const Film film = synthetic_film(8, 8, 64, 1, [](int x, int, auto&) { return Rgbd(0.1 + x / 3.0); });
  const ImageError error = image_error(film);
  EXPECT_EQ(error.grade, ErrorGrade::kMeasured);
  EXPECT_EQ(error.error.high, 0.0);
  EXPECT_EQ(error_notices(error, true), (Notices{"no_variance"}));
}

TEST(ImageError, ABlackPictureHasNoRelativeError) {
  const Film film = synthetic_film(8, 8, 64, 1, [](int, int, auto&) { return Rgbd(0.0); });
  const ImageError error = image_error(film);
  EXPECT_EQ(error.grade, ErrorGrade::kUnknown);
  EXPECT_TRUE(error.no_variance);
  EXPECT_EQ(unseen_bound(5.0, 300), 0.05);
  EXPECT_EQ(unseen_bound(5.0, 0), 5.0);
}

TEST(QuickImageError, IsThatOfTheWholeWhereThePictureIsSmall) {
  const Film film = synthetic_film(96, 64, 4, 3, [](int, int, auto& random) { return Rgbd(random.uniform()); });
  const ImageError quick = quick_image_error(film);
  EXPECT_FALSE(quick.sampled);
  EXPECT_EQ(quick.error.high, image_error(film).error.high);
}

TEST(QuickImageError, SaysThatItIsASampleAndWhatHasNoFigure) {
  Film film(160, 120);
  EXPECT_EQ(error_notices(quick_image_error(film), true), (Notices{"unsampled_pixels", "error_unknown", "error_sampled"}));
  const Film still = synthetic_film(160, 120, 2, 1, [](int x, int, auto&) { return Rgbd(1.0 + x); });
  const ImageError none = quick_image_error(still);
  EXPECT_EQ(none.error.high, 0.0);
  EXPECT_EQ(error_notices(none, true), (Notices{"error_rough", "error_sampled", "no_variance"}));
}

TEST(ImageError, ScalesWithTheLight) {
  const auto film = [](double scale) {
    return synthetic_film(16, 40, 64, 7, [scale](int x, int y, auto& random) {
      return Rgbd(scale * (x + 1) * random.uniform(), scale * random.uniform(), scale * y);
    });
  };
  const ImageError one = image_error(film(1.0)), large = image_error(film(0x1p40));
  EXPECT_EQ(one.rel_mse.value, large.rel_mse.value);
  EXPECT_EQ(one.error.low, large.error.low);
  EXPECT_EQ(one.rmse.value * 0x1p40, large.rmse.value);
}

TEST(TrueError, ByHand) {
  const std::vector<double> truth{1, 1, 1, 3, 3, 3}, picture{1, 1, 2, 3, 3, 3};
  const TrueError error = true_error(picture, truth);
  EXPECT_DOUBLE_EQ(error.rel_mse, 1.0 / (1.0 + 0.04) / 6.0);
  EXPECT_DOUBLE_EQ(error.rmse, std::sqrt(1.0 / 6.0));
  EXPECT_EQ(error.display_rmse, 0.0);  // both are clipped to white
  EXPECT_EQ(true_error(truth, truth).error, 0.0);
}

}  // namespace
}  // namespace raykiln::render
