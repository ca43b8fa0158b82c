#include <gtest/gtest.h>

#include <cmath>

#include "raykiln/accuracy/pixel_error.hpp"
#include "support/synthetic_film.hpp"

namespace raykiln::render {
namespace {

using support::synthetic_film;

TEST(PixelError, OfOnePixelIsTheTextbookFormula) {
  // 1, 3, 3, 5: mean 3, sum of squared deviations 8, variance of the mean 8 / (4 * 3).
  int i = 0;
  const double values[] = {1, 3, 3, 5};
  const Film film = synthetic_film(1, 1, 4, 1, [&](int, int, auto&) {
    const double v = values[i++];
    return Rgbd(v, 2.0 * v, 0.0);
  });
  const PixelErrors errors = pixel_errors(film);
  EXPECT_DOUBLE_EQ(errors.mean[0], 3.0);
  EXPECT_NEAR(errors.standard_error[0], std::sqrt(8.0 / 12.0), 1e-15);
  EXPECT_NEAR(errors.standard_error[1], 2.0 * std::sqrt(8.0 / 12.0), 1e-15);
  EXPECT_EQ(errors.standard_error[2], 0.0);
}

TEST(PixelError, IsUnknownBelowTwoSamples) {
  Film film(3, 1);
  BlockResult one{.block = sample_block(0), .planes = make_block_planes(2)};
  add_sample(one.planes, 0, Rgbd(0.5), false);
  add_sample(one.planes, 1, Rgbd(0.5), false);
  film.fold({1, 0, 3, 1}, one);
  BlockResult two{.block = sample_block(1), .planes = make_block_planes(1)};
  add_sample(two.planes, 0, Rgbd(0.7), false);
  film.fold({2, 0, 3, 1}, two);
  const PixelErrors errors = pixel_errors(film);
  EXPECT_TRUE(std::isnan(errors.standard_error[0]));
  EXPECT_TRUE(std::isnan(errors.standard_error[3]));
  EXPECT_NEAR(errors.standard_error[6], 0.1, 1e-6);  // |0.7 - 0.5| / 2
  EXPECT_TRUE(std::isfinite(errors.mean[0]));
}

TEST(PixelError, OfCopiedRowsIsThatOfTheFilm) {
  const Film film = synthetic_film(5, 7, 8, 3, [](int x, int y, auto& random) {
    const double value = (x + y) % 3 + -std::log(1.0 - random.uniform());
    return Rgbd(value, 0.5 * value, 2.0 * value);
  });
  std::vector<PixelSums> rows;  // 1 to 4, for what is in 2 and 3
  for (std::size_t i = 5; i < 25; ++i) rows.push_back(film.pixel(i));
  const PixelErrors whole = pixel_errors(film), part = pixel_errors(rows, 5, film.relation());
  EXPECT_EQ(part.height, 4);
  for (std::size_t i = 15; i < 45; ++i) {
    EXPECT_EQ(part.standard_error[i], whole.standard_error[i + 15]);
    EXPECT_EQ(part.mean[i], whole.mean[i + 15]);
  }
}

TEST(PixelError, APixelWithoutAnEventIsNotCertain) {
  // All pixels but the middle one have seen a bright sample.
  const Film film = synthetic_film(5, 5, 64, 1, [](int x, int y, auto& random) {
    const bool dark = x == 2 && y == 2;
    return Rgbd(!dark && random.uniform() < 0.1 ? 10.0 : 0.0);
  });
  const std::vector<double> errors = pixel_errors(film).standard_error;
  EXPECT_GT(errors[36], 0.8 * std::sqrt(0.1 * 0.9 * 100.0 / 64.0) * std::sqrt(8.0 / 9.0) * 0.8);
  for (const double e : errors) EXPECT_GT(e, 0.0);
}

}  // namespace
}  // namespace raykiln::render
