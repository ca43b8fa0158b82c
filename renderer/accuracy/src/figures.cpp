#include "figures.hpp"

#include <cmath>

#include "raykiln/accuracy/quantiles.hpp"

namespace raykiln::render {
namespace {

constexpr double kTailImage = 0.4;  ///< part of rel_mse in tails that raises the flag
constexpr double kTailWidening = 3.0;

Figure figure(const Square& square, double widening) {
  if (!(square.value > 0.0)) return {};
  const double spread = kNormal95 * widening * std::sqrt(square.variance);
  return {.value = square.value, .low = square.value * std::exp(-spread), .high = square.value * std::exp(spread)};
}

Figure root(const Figure& square) {
  return {std::sqrt(square.value), std::sqrt(square.low), std::sqrt(square.high)};
}

}  // namespace

bool note_survey(ImageError& error, const Survey& survey) {
  error.unsampled_pixels = survey.unsampled;
  error.least_samples = survey.least;
  error.mean_samples = survey.samples();
  error.mean = survey.mean();
  if (survey.unknown > 0) return false;
  error.no_variance = !survey.varies();
  return error.mean > 0.0;
}

void set_figures(ImageError& error, const Squares& squares, double tails) {
  error.grade = error.least_samples < kSampleFloor ? ErrorGrade::kRough : ErrorGrade::kMeasured;
  error.heavy_tailed = tails > kTailImage;
  const double widening = error.heavy_tailed ? kTailWidening : 1.0;
  error.rel_mse = figure(squares.relative, widening);
  error.error = root(error.rel_mse);
  error.rmse = root(figure(squares.linear, widening));
  error.display_rmse = root(figure(squares.display, widening));
}

}  // namespace raykiln::render
