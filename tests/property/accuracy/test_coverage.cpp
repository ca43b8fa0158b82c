// Intervals against the truth over many seeds of pictures whose truth is known.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "raykiln/accuracy/image_error.hpp"
#include "raykiln/accuracy/pixel_error.hpp"
#include "raykiln/accuracy/quantiles.hpp"
#include "raykiln/accuracy/true_error.hpp"
#include "support/synthetic_film.hpp"

namespace raykiln::render {
namespace {

using support::synthetic_film;
using support::synthetic_truth;
using support::TestRandom;

constexpr int kSeeds = 200;
constexpr int kWidth = 24, kHeight = 24;

struct Picture {
  const char* name;
  std::function<Rgbd(int, int)> truth;
  std::function<Rgbd(const Rgbd&, TestRandom&)> sample;
};

Rgbd ramp(int x, int y) { return {0.2 + 0.05 * x, 0.3 + 0.03 * y, 0.1}; }
Rgbd edge(int x, int y) { return Rgbd((x + 2 * y) % 16 < 8 ? 1.0 : 0.02); }
Rgbd grey_exponential(const Rgbd& r, TestRandom& random) { return r * random.exponential(); }
Rgbd coloured_uniform(const Rgbd& r, TestRandom& random) {
  return {r.x * 2.0 * random.uniform(), r.y * 2.0 * random.uniform(), r.z * 2.0 * random.uniform()};
}
Rgbd half_dark(const Rgbd& r, TestRandom& random) {
  return random.uniform() < 0.3 ? r * (1.0 / 0.3) : Rgbd(0.0);
}

class Coverage : public ::testing::TestWithParam<Picture> {};

TEST_P(Coverage, OfTheErrorOfThePicture) {
  const auto& [label, truth, sample] = GetParam();
  const std::vector<double> reference = synthetic_truth(kWidth, kHeight, truth);
  int error = 0, rmse = 0, display = 0, flagged = 0;
  double ratio = 0.0;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const Film film = synthetic_film(kWidth, kHeight, 64, seed, [&](int x, int y, TestRandom& random) {
      return sample(truth(x, y), random);
    });
    const ImageError shown = image_error(film);
    const TrueError real = true_error(pixel_errors(film).mean, reference);
    error += shown.error.low <= real.error && real.error <= shown.error.high ? 1 : 0;
    rmse += shown.rmse.low <= real.rmse && real.rmse <= shown.rmse.high ? 1 : 0;
    display += shown.display_rmse.low <= real.display_rmse && real.display_rmse <= shown.display_rmse.high ? 1 : 0;
    flagged += shown.heavy_tailed ? 1 : 0;
    ratio += real.rel_mse / shown.rel_mse.value / kSeeds;
  }
  RecordProperty("error", error);
  RecordProperty("rmse", rmse);
  RecordProperty("display", display);
  RecordProperty("ratio", std::to_string(ratio));
  EXPECT_GE(error, 180) << label;
  EXPECT_LE(error, 198) << label;
  EXPECT_GE(rmse, 180) << label;
  EXPECT_GE(display, 180) << label;
  EXPECT_NEAR(ratio, 1.0, 0.03) << label;
  EXPECT_EQ(flagged, 0) << label;
}

TEST_P(Coverage, OfSinglePixels) {
  const auto& [label, truth, sample] = GetParam();
  const std::vector<double> reference = synthetic_truth(kWidth, kHeight, truth);
  std::uint64_t inside = 0, all = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Film film = synthetic_film(kWidth, kHeight, 64, 1000 + seed, [&](int x, int y, TestRandom& random) {
      return sample(truth(x, y), random);
    });
    const PixelErrors errors = pixel_errors(film);
    const double t = student_t95(63.0);
    for (std::size_t i = 0; i < reference.size(); i += 3, ++all) {
      inside += std::abs(errors.mean[i] - reference[i]) <= t * errors.standard_error[i] ? 1U : 0U;
    }
  }
  const double share = static_cast<double>(inside) / static_cast<double>(all);
  RecordProperty("share", std::to_string(share));
  EXPECT_GE(share, 0.93) << label;
  EXPECT_LE(share, 0.97) << label;
}

// A look at part of the pixels of pictures whose noise is uneven: its interval holds the real error of them all.
TEST_P(Coverage, OfTheErrorFromASampleOfThePixels) {
  const auto& [label, truth, sample] = GetParam();
  constexpr int kAcross = 144, kDown = 100, kLooks = 24;
  const auto scaled = [&, &light = truth](int x, int y) { return light(x / 6, y / 5); };
  const std::vector<double> reference = synthetic_truth(kAcross, kDown, scaled);
  int held = 0;
  double ratio = 0.0, width = 0.0;
  for (std::uint64_t seed = 0; seed < kLooks; ++seed) {
    const Film film = synthetic_film(kAcross, kDown, 8, seed, [&](int x, int y, TestRandom& random) {
      const double calm = (x - 90) * (x - 90) + (y - 30) * (y - 30) < 400 ? 0.0 : 0.6;  // a noisy disc
      const Rgbd light = scaled(x, y);
      return light * calm + sample(light, random) * (1.0 - calm);
    });
    const ImageError shown = quick_image_error(film);
    ASSERT_TRUE(shown.sampled);
    const TrueError real = true_error(pixel_errors(film).mean, reference);
    held += shown.error.low <= real.error && real.error <= shown.error.high ? 1 : 0;
    ratio += real.rel_mse / shown.rel_mse.value / kLooks;
    width += std::log(shown.error.high / shown.error.low) / kLooks;
  }
  RecordProperty("held", held);
  RecordProperty("ratio", std::to_string(ratio));
  RecordProperty("width", std::to_string(std::exp(width)));
  EXPECT_GE(held, 19) << label;  // 22.8 expected, less 3.6 standard deviations
  EXPECT_NEAR(ratio, 1.0, 0.08) << label;
  EXPECT_LE(std::exp(width), 1.5) << label;
}

INSTANTIATE_TEST_SUITE_P(
    Pictures, Coverage,
    ::testing::Values(Picture{"ramp", ramp, grey_exponential}, Picture{"colours", ramp, coloured_uniform},
                      Picture{"light_that_is_often_missed", ramp, half_dark},
                      Picture{"edge", edge, grey_exponential}),
    [](const auto& shown) { return std::string(shown.param.name); });

}  // namespace
}  // namespace raykiln::render
