// Means and variances of a range of rows, and means over windows of pixels.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "raykiln/image/film.hpp"

namespace raykiln::render {

/// What the samples of one pixel say. Variances are of the mean: unbiased, divided by n.
struct PixelStatistics {
  std::uint64_t samples = 0;
  std::array<double, 3> mean{}, variance{};
  double luminance = 0.0, luminance_variance = 0.0;
  /// (largest sample - mean)^2 over the sum of all squared deviations of luminance, in [0, 1]: an
  /// upper bound of the relative variance of the variance, and near 1 when one sample makes it up.
  double largest_share = 0.0;
  double replicate_variance = 0.0;  ///< of luminance, from the means of the replicates
  bool known = false;               ///< at least 2 samples: the variances are valid
};
[[nodiscard]] PixelStatistics pixel_statistics(const PixelSums& sums);

/// Sums over windows of (2 radius + 1)^2 pixels, cut at the borders of a width x height array, all of
/// them in O(pixels).
[[nodiscard]] std::vector<double> window_sums(const std::vector<double>& values, int width,
                                              int height, int radius);

}  // namespace raykiln::render
