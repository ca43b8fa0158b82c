// What a linear value looks like on a display.
#pragma once

#include <algorithm>

#include "raykiln/math/srgb.hpp"

namespace raykiln::render {

/// In sRGB. Clipped to [0, 1] first; NaN shows as black.
[[nodiscard]] inline double display_value(double linear) {
  if (!(linear > 0.0)) return 0.0;
  return srgb_of_linear(std::min(linear, 1.0));
}

}  // namespace raykiln::render
