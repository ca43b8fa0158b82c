// Sums over windows of pixels.
#pragma once

#include <cstddef>
#include <vector>

#include "raykiln/image/film.hpp"

namespace raykiln::render {

/// Windows of (2 radius + 1)^2 pixels, cut at the borders of a width x height array.
struct Windows {
  int width = 0, height = 0, radius = 0;

  /// Of all pixels, in O(pixels).
  [[nodiscard]] std::vector<double> sums(const std::vector<double>& values) const;

  /// Pixels of the window about each pixel.
  [[nodiscard]] std::vector<double> counts() const;

  /// Means of the windows without the pixel in their middle; 0 where it is alone.
  [[nodiscard]] std::vector<double> means_of_others(const std::vector<double>& values) const;

  /// visit(index) for the pixels of a part of the array, row by row.
  template <typename Visit>
  void each(const PixelRect& part, Visit visit) const {
    for (int y = part.y0; y < part.y1; ++y) {
      const auto row = static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
      for (int x = part.x0; x < part.x1; ++x) visit(row + static_cast<std::size_t>(x));
    }
  }
};

}  // namespace raykiln::render
