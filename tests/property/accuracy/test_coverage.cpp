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

INSTANTIATE_TEST_SUITE_P(
    Pictures, Coverage,
    ::testing::Values(Picture{"ramp", ramp, grey_exponential}, Picture{"colours", ramp, coloured_uniform},
                      Picture{"light_that_is_often_missed", ramp, half_dark},
                      Picture{"edge", edge, grey_exponential}),
    [](const auto& shown) { return std::string(shown.param.name); });

}  // namespace
}  // namespace raykiln::render
