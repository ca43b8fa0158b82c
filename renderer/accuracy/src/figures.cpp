#include "figures.hpp"

#include <algorithm>
#include <cmath>

#include "raykiln/accuracy/quantiles.hpp"

namespace raykiln::render {
namespace {

constexpr double kTailImage = 0.4;  ///< part of rel_mse in tails that raises the flag
/// Parts of rel_mse in tails up to which intervals are as they are, and from which on they are widest.
constexpr double kTailsNone = 0.2, kTailsAll = 0.8;
constexpr double kTailWidening = 3.0;

/// Grows with the tails instead of beginning at the flag: a picture that is about to raise or lose it is judged alike on
/// both sides, and what is not flagged yet has some of the doubt already.
double widening_of(double tails) {
  const double part = std::clamp((tails - kTailsNone) / (kTailsAll - kTailsNone), 0.0, 1.0);
  return 1.0 + (kTailWidening - 1.0) * part;
}

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
  const double widening = widening_of(tails);
  error.rel_mse = figure(squares.relative, widening);
  error.error = root(error.rel_mse);
  error.rmse = root(figure(squares.linear, widening));
  error.display_rmse = root(figure(squares.display, widening));
}

}  // namespace raykiln::render
