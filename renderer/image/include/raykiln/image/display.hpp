// What a linear value looks like on a display.
#pragma once

#include <algorithm>
#include <cmath>

namespace raykiln::render {

/// IEC 61966-2-1: linear to sRGB, both in [0, 1].
[[nodiscard]] inline double srgb_from_linear(double x) {
  return x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1.0 / 2.4) - 0.055;
}

/// Clipped to [0, 1] first; NaN shows as black.
[[nodiscard]] inline double display_value(double linear) {
  if (!(linear > 0.0)) return 0.0;
  return srgb_from_linear(std::min(linear, 1.0));
}

}  // namespace raykiln::render
