// From sums of squared errors to what is shown.
#pragma once

#include "raykiln/accuracy/image_error.hpp"
#include "region_error.hpp"

namespace raykiln::render {

/// An estimated mean square and the relative variance of (real - estimate).
struct Square {
  double value = 0.0, variance = 0.0;
};
struct Squares {
  Square relative, linear, display;
};

/// Takes over counts and mean. False when there is nothing to judge: unknown pixels, or a black picture.
[[nodiscard]] bool note_survey(ImageError& error, const Survey& survey);

/// Grade, flag, and figures with intervals; log-normal, so that they cannot reach below 0. `tails`: part of the
/// relative squares in places where few samples make up the variance.
void set_figures(ImageError& error, const Squares& squares, double tails);

}  // namespace raykiln::render
