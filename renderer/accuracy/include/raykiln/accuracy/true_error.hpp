// The error against a known truth: what estimates are judged by.
#pragma once

#include <span>

namespace raykiln::render {

struct TrueError {
  double rel_mse = 0.0, error = 0.0, rmse = 0.0, display_rmse = 0.0;  ///< as in ImageError
};

/// Precondition: equal sizes, three channels a pixel, not empty.
[[nodiscard]] TrueError true_error(std::span<const double> picture, std::span<const double> truth,
                                   double exposure_stops = 0.0);

}  // namespace raykiln::render
