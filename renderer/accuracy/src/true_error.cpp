#include "raykiln/accuracy/true_error.hpp"

#include <cmath>
#include <numeric>

#include "raykiln/image/display.hpp"

namespace raykiln::render {

TrueError true_error(std::span<const double> picture, std::span<const double> truth,
                     double exposure_stops) {
  const auto values = static_cast<double>(truth.size());
  const double mean = std::accumulate(truth.begin(), truth.end(), 0.0) / values;
  const double gain = std::exp2(exposure_stops), floor = 0.01 * mean * mean;
  double relative = 0.0, squares = 0.0, shown = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const double r = truth[i], square = (picture[i] - r) * (picture[i] - r);
    const double display = display_value(gain * picture[i]) - display_value(gain * r);
    squares += square;
    shown += display * display;
    if (square > 0.0) relative += square / (r * r + floor);
  }
  return {.rel_mse = relative / values,
          .error = std::sqrt(relative / values),
          .rmse = std::sqrt(squares / values),
          .display_rmse = std::sqrt(shown / values)};
}

}  // namespace raykiln::render
