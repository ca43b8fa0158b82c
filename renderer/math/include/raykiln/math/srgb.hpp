// The transfer curve of sRGB, IEC 61966-2-1.
#pragma once

#include <cmath>

namespace raykiln::render {

/// Linear value of a display value in [0, 1]; 0 and 1 exactly.
[[nodiscard]] inline double linear_of_srgb(double display) {
  if (display <= 0.04045) return display / 12.92;
  if (display == 1.0) return 1.0;
  return std::pow((display + 0.055) / 1.055, 2.4);
}

/// Display value of a linear value in [0, 1]; larger ones go on along the curve.
[[nodiscard]] inline double srgb_of_linear(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}

}  // namespace raykiln::render
