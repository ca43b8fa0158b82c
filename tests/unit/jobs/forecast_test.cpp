#include <gtest/gtest.h>

#include <cmath>

#include "raykiln/jobs/forecast.hpp"

namespace raykiln::server {
namespace {

/// Points of error = scale * t^slope with 2 % wide intervals.
std::vector<CurvePoint> line(double slope, double from, double to, double step = 1.1) {
  std::vector<CurvePoint> curve;
  for (double t = from; t <= to; t *= step) {
    CurvePoint point;
    point.render_seconds = t;
    point.error.value = 0.3 * std::pow(t, slope);
    point.error.low = 0.99 * point.error.value;
    point.error.high = 1.01 * point.error.value;
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
  const auto range = seconds_to_error(curve, curve.back().error.value / 2.0, false);
  ASSERT_TRUE(range);
  EXPECT_NEAR(range->value / curve.back().render_seconds, 4.0, 1e-9);
  EXPECT_LT(range->high / range->low, 2.0);
  const auto tails = seconds_to_error(curve, curve.back().error.value / 2.0, true);
  EXPECT_NEAR(std::log(tails->high / tails->low), 3.0 * std::log(range->high / range->low), 1e-9);
  EXPECT_FALSE(seconds_to_error({}, 0.1, false));
  EXPECT_FALSE(seconds_to_error(curve, 0.0, false));
}

TEST(Forecast, IsKeptAndScoredWhenItsErrorIsReached) {
  std::vector<Forecast> forecasts;
  std::vector<CurvePoint> curve;
  int scored = 0, hits = 0;
  for (const CurvePoint& point : line(-0.5, 1.0, 1000.0)) {
    curve.push_back(point);
    for (const Forecast& f : update_forecasts(forecasts, curve, false)) {
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
