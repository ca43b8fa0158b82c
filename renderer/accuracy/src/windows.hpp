// Sums over windows of pixels.
#pragma once

#include <cstddef>
#include <vector>

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
};

}  // namespace raykiln::render
