#include <gtest/gtest.h>

#include <cmath>

#include "raykiln/jobs/forecast.hpp"

namespace raykiln::server {
namespace {

/// Points of error = scale * t^slope with 2 % wide intervals, `wide` times so in the logarithm.
std::vector<CurvePoint> line(double slope, double from, double to, double step = 1.1, double wide = 1.0) {
  std::vector<CurvePoint> curve;
  for (double t = from; t <= to; t *= step) {
    CurvePoint point;
    point.render_seconds = t;
    point.samples = 16.0 * t;
    point.error.value = 0.3 * std::pow(t, slope);
    point.error.low = std::pow(0.99, wide) * point.error.value;
    point.error.high = std::pow(1.01, wide) * point.error.value;
    curve.push_back(point);
  }
  return curve;
}

TEST(Forecast, TheSlopeOfALineIsFound) {
  const auto fit = fit_slope(line(-0.5, 1.0, 100.0));
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->slope, -0.5, 1e-12);
  EXPECT_EQ(fit->standard_error, 0.02) << "points of one film scatter less than they know";
  EXPECT_NEAR(fit_slope(line(-0.7, 0.01, 3.0))->slope, -0.7, 1e-12);
  EXPECT_FALSE(fit_slope({}));
  EXPECT_FALSE(fit_slope(line(-0.5, 1.0, 1.5))) << "too short";
}

TEST(Forecast, HalfTheErrorTakesFourTimesTheTime) {
  const auto curve = line(-0.5, 1.0, 10.0);
  const auto range = seconds_to_error(curve, curve.back().error.value / 2.0, Basis::kMeasured);
  ASSERT_TRUE(range);
  EXPECT_NEAR(range->value / curve.back().render_seconds, 4.0, 1e-9);
  EXPECT_LT(range->high / range->low, 2.0);
  // Three times as wide: where tails are heavy the points' intervals are so already.
  const double wide = 3.0 * std::log(range->high / range->low), half = curve.back().error.value / 2.0;
  const auto rough = seconds_to_error(curve, half, Basis::kRough);
  const auto tails = seconds_to_error(line(-0.5, 1.0, 10.0, 1.1, 3.0), half, Basis::kHeavyTailed);
  EXPECT_NEAR(std::log(rough->high / rough->low), wide, 1e-9);
  EXPECT_NEAR(std::log(tails->high / tails->low), wide, 1e-9);
  EXPECT_FALSE(seconds_to_error({}, 0.1, Basis::kMeasured));
  EXPECT_FALSE(seconds_to_error(curve, 0.0, Basis::kMeasured));
}

TEST(Forecast, IsNotMadeBeforeThereIsABasis) {
  std::vector<Forecast> forecasts;
  update_forecasts(forecasts, line(-0.5, 0.1, 0.99), Basis::kMeasured);  // 15 samples
  EXPECT_TRUE(forecasts.empty());
  update_forecasts(forecasts, line(-0.5, 0.1, 1.1), Basis::kMeasured);
  EXPECT_EQ(forecasts.size(), 1U);
  PictureError error;
  error.grade = "rough";
  EXPECT_EQ(basis_of(error), Basis::kRough);
  error.grade = "measured";
  EXPECT_EQ(basis_of(error), Basis::kMeasured);
  error.heavy_tailed = true;
  EXPECT_EQ(basis_of(error), Basis::kHeavyTailed);
}

TEST(Forecast, IsKeptAndScoredWhenItsErrorIsReached) {
  std::vector<Forecast> forecasts;
  std::vector<CurvePoint> curve;
  int scored = 0, hits = 0;
  for (const CurvePoint& point : line(-0.5, 1.0, 1000.0)) {
    curve.push_back(point);
    for (const Forecast& f : update_forecasts(forecasts, curve, Basis::kMeasured)) {
      ++scored;
      hits += f.hit() ? 1 : 0;
      EXPECT_NEAR(*f.actual, 4.0 * f.made_at, 1e-6 * f.made_at);
    }
  }
  EXPECT_GE(scored, 7);
  EXPECT_EQ(hits, scored);
  EXPECT_LE(forecasts.size(), 11U) << "one a doubling";
  EXPECT_FALSE(forecasts.back().actual);
  EXPECT_FALSE(forecasts.back().hit());
}

}  // namespace
}  // namespace raykiln::server
