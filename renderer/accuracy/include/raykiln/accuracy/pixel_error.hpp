// The error of single pixels: the layer behind the picture.
#pragma once

#include <vector>

#include "raykiln/image/film.hpp"

namespace raykiln::render {

/// Three channels a pixel, interleaved, row-major, as the picture; in double.
struct PixelErrors {
  int width = 0, height = 0;
  std::vector<double> mean;            ///< 0 without a sample
  std::vector<double> standard_error;  ///< of the mean, radiance; NaN (unknown) below 2 samples
};

/// The standard error is that of the 3 x 3 pixels around (root of their mean variance): a pixel that no
/// sample has brightened is not certain for that. Only a pixel whose own variance is larger by more
/// than two standard errors keeps its own.
[[nodiscard]] PixelErrors pixel_errors(const Film& film);

/// Standard error of luminance, one float a pixel, as above: what is shown in false colour.
[[nodiscard]] std::vector<float> luminance_errors(const Film& film);

}  // namespace raykiln::render
