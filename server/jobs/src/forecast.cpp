#include "raykiln/jobs/forecast.hpp"

#include <algorithm>
#include <cmath>

namespace raykiln::server {
namespace {

constexpr double kNormal90 = 1.6448536269514722, kNormal95 = 1.959963984540054;
constexpr double kFitSpan = 16.0, kLeastSpan = 2.0;
constexpr std::size_t kLeastPoints = 4;
constexpr double kLeastSlopeError = 0.02;
constexpr double kPriorSlope = -0.5, kPriorSlopeError = 0.03;
constexpr double kSpeedSpread = 0.1;
constexpr double kTailWidening = 3.0;

bool usable(const CurvePoint& p) { return p.render_seconds > 0.0 && p.error.value > 0.0; }

/// The fitted slope and what independent samples give, weighed by their precision.
SlopeFit weighed_slope(const std::vector<CurvePoint>& curve) {
  const auto fit = fit_slope(curve);
  if (!fit) return {kPriorSlope, kPriorSlopeError, 0};
  const double prior = 1.0 / (kPriorSlopeError * kPriorSlopeError);
  const double fitted = 1.0 / (fit->standard_error * fit->standard_error);
  return {(prior * kPriorSlope + fitted * fit->slope) / (prior + fitted),
          1.0 / std::sqrt(prior + fitted), fit->points};
}

}  // namespace

std::optional<SlopeFit> fit_slope(const std::vector<CurvePoint>& curve) {
  double n = 0, sx = 0, sy = 0, first = 0, last = 0;
  const auto each = [&](auto&& visit) {
    for (const CurvePoint& p : curve) {
      if (usable(p) && kFitSpan * p.render_seconds >= curve.back().render_seconds) {
        visit(std::log(p.render_seconds), std::log(p.error.value));
      }
    }
  };
  each([&](double x, double y) {
    first = n == 0 ? x : first;
    last = x;
    n += 1;
    sx += x;
    sy += y;
  });
  if (n < static_cast<double>(kLeastPoints) || last - first < std::log(kLeastSpan)) return std::nullopt;
  double sxx = 0, sxy = 0, syy = 0;
  each([&](double x, double y) {
    sxx += (x - sx / n) * (x - sx / n);
    sxy += (x - sx / n) * (y - sy / n);
    syy += (y - sy / n) * (y - sy / n);
  });
  const double slope = sxy / sxx;
  const double residual = std::max(0.0, syy - slope * sxy) / (n - 2.0);
  return SlopeFit{slope, std::max(kLeastSlopeError, std::sqrt(residual / sxx)), static_cast<std::size_t>(n)};
}

Basis basis_of(const PictureError& error) {
  if (error.heavy_tailed) return Basis::kHeavyTailed;
  return error.grade == "measured" ? Basis::kMeasured : Basis::kRough;
}

std::optional<TimeRange> seconds_to_error(const std::vector<CurvePoint>& curve, double error,
                                          Basis basis) {
  if (curve.empty() || !usable(curve.back()) || !(error > 0.0)) return std::nullopt;
  const CurvePoint& now = curve.back();
  const SlopeFit fit = weighed_slope(curve);
  const double way = std::log(now.error.value / error), beta = std::max(0.05, -fit.slope);
  const double of_error = std::log(now.error.high / now.error.low) / (2.0 * kNormal95) / beta;
  const double of_slope = way * fit.standard_error / (beta * beta);
  const double of_speed = kSpeedSpread * std::min(1.0, std::abs(way));
  const double wide = basis == Basis::kMeasured ? 1.0 : kTailWidening;
  const double of_estimates = of_error * (basis == Basis::kRough ? wide : 1.0);
  const double value = now.render_seconds * std::exp(way / beta);
  // Of k times the samples 1/k are those of now: the estimates differ with 1 + 1/k - 2/k of its variance,
  // and with 1/k + 1 - 2 where k < 1.
  const double apart = std::abs(1.0 - now.render_seconds / value);
  const double spread = kNormal90 * std::sqrt(apart * of_estimates * of_estimates +
                                              wide * wide * (of_slope * of_slope + of_speed * of_speed));
  return TimeRange{value, value * std::exp(-spread), value * std::exp(spread)};
}

std::vector<Forecast> update_forecasts(std::vector<Forecast>& forecasts,
                                       const std::vector<CurvePoint>& curve, Basis basis) {
  std::vector<Forecast> scored;
  if (curve.empty() || !usable(curve.back())) return scored;
  const CurvePoint& now = curve.back();
  for (Forecast& forecast : forecasts) {
    if (forecast.actual || now.error.value > forecast.error) continue;
    double reached = now.render_seconds;
    if (curve.size() > 1 && usable(curve[curve.size() - 2])) {
      const CurvePoint& before = curve[curve.size() - 2];
      const double all = std::log(before.error.value / now.error.value);
      const double part = std::log(before.error.value / forecast.error);
      if (all > 0.0 && part > 0.0) {
        reached = before.render_seconds * std::pow(now.render_seconds / before.render_seconds, part / all);
      }
    }
    forecast.actual = reached;
    scored.push_back(forecast);
  }
  const bool due = forecasts.empty() || now.render_seconds >= 2.0 * forecasts.back().made_at;
  if (!due || now.samples < kForecastFloor || forecasts.size() >= kMostForecasts) return scored;
  const double half = now.error.value / 2.0;
  if (const auto range = seconds_to_error(curve, half, basis)) {
    forecasts.push_back({.made_at = now.render_seconds, .error = half, .seconds = *range});
  }
  return scored;
}

}  // namespace raykiln::server
