// A picture with what is known about its noise.
#pragma once

#include <cstddef>
#include <vector>

#include "raykiln/image/film.hpp"

namespace raykiln::render {

/// Linear RGB means with their standard errors. All planes are row-major, row 0 at the top.
struct MeasuredImage {
  Image mean;
  std::vector<float> error;    ///< standard error of the mean, 3 a pixel; empty: unknown
  std::vector<float> samples;  ///< samples of the mean, 1 a pixel; empty: unknown

  [[nodiscard]] std::size_t pixels() const { return mean.rgb.size() / 3; }
  [[nodiscard]] bool has_noise() const {
    return !error.empty() && error.size() == mean.rgb.size() && samples.size() == pixels();
  }
};

}  // namespace raykiln::render
