// How long until the error is so small: the line through error against time, and forecasts that are
// kept and scored.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "raykiln/jobs/picture_error.hpp"

namespace raykiln::server {

/// ln error = slope ln seconds + constant. -1/2 where samples are independent.
struct SlopeFit {
  double slope = -0.5, standard_error = 0.0;
  std::size_t points = 0;
};

/// Least squares over the points in the last factor of 16 of time; nothing below 4 points or a factor
/// of 2 of time. The standard error is never below 0.02: the points share their samples, so that they
/// scatter less about a line than they would if each was rendered anew.
[[nodiscard]] std::optional<SlopeFit> fit_slope(const std::vector<CurvePoint>& curve);

/// Render seconds with a 90 % range.
struct TimeRange {
  double value = 0.0, low = 0.0, high = 0.0;
};

/// What the points of a curve are worth to a forecast.
enum class Basis {
  kMeasured,
  kRough,        ///< too few samples to tell whether tails are heavy: ranges three times as wide
  kHeavyTailed,  ///< three times as wide; the intervals of the points are so already
};
[[nodiscard]] Basis basis_of(const PictureError& error);

/// Render seconds, from the beginning, at which `error` will be (or was) reached; nothing without a
/// point. The slope is the fitted one weighed with -1/2 +- 0.03; errors, slope and a tenth for the speed of
/// the machine are added in squares. Widths are meant in the logarithm.
[[nodiscard]] std::optional<TimeRange> seconds_to_error(const std::vector<CurvePoint>& curve, double error,
                                                        Basis basis);

/// What was said at `made_at` about the time to reach an error.
struct Forecast {
  double made_at = 0.0;      ///< render seconds
  double error = 0.0;        ///< the error forecast: half of what it was then
  TimeRange seconds;
  std::optional<double> actual{};  ///< render seconds at which it was reached
  [[nodiscard]] bool hit() const { return actual && seconds.low <= *actual && *actual <= seconds.high; }
};
inline constexpr std::size_t kMostForecasts = 32;
/// Samples a pixel from which on forecasts are made: before, what makes up the error may not have come once.
inline constexpr double kForecastFloor = 16.0;

/// After a new point of the curve: makes a forecast if the last one is half the time ago and the floor is
/// reached, and scores those
/// whose error has been reached (between the points, on the line through them). Returns those scored now.
std::vector<Forecast> update_forecasts(std::vector<Forecast>& forecasts,
                                       const std::vector<CurvePoint>& curve, Basis basis);

}  // namespace raykiln::server
