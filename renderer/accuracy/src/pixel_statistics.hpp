// What the samples of one pixel say.
#pragma once

#include <array>
#include <cstdint>

#include "raykiln/image/film.hpp"

namespace raykiln::render {

/// Variances are of the mean: unbiased, divided by n.
struct PixelStatistics {
  std::uint64_t samples = 0;
  std::array<double, 3> mean{}, variance{};
  double luminance = 0.0, luminance_variance = 0.0;
  /// (largest sample - mean)^2 over the sum of all squared deviations of luminance, in [0, 1]: an
  /// upper bound of the relative variance of the variance, and near 1 when one sample makes it up.
  double largest_share = 0.0;
  /// Luminance that the mean would lose without the largest sample, and the variance of what is left.
  double of_largest = 0.0, variance_without = 0.0;
  bool known = false;  ///< at least 2 samples: the variances are valid
};
[[nodiscard]] PixelStatistics pixel_statistics(const PixelSums& sums);

}  // namespace raykiln::render
