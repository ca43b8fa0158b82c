// The error of single pixels: the layer behind the picture.
#pragma once

#include <span>
#include <vector>

#include "raykiln/image/film.hpp"

namespace raykiln::render {

/// Three channels a pixel, interleaved, row-major, as the picture; in double.
struct PixelErrors {
  int width = 0, height = 0;
  std::vector<double> mean;            ///< 0 without a sample
  std::vector<double> standard_error;  ///< of the mean, radiance; NaN (unknown) below 2 samples
};

/// Each variance is drawn to the mean of the 3 x 3 pixels around by the share that its own scatter has
/// in the differences between them: a pixel that no sample has brightened is not certain for that, and
/// at an edge a pixel keeps most of its own.
[[nodiscard]] PixelErrors pixel_errors(const Film& film);

/// The same of whole rows that were copied from a film. With the row above and the row below, those between are as in the film.
[[nodiscard]] PixelErrors pixel_errors(std::span<const PixelSums> pixels, int width, SampleRelation relation);

}  // namespace raykiln::render
