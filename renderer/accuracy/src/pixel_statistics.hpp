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
  /// Relative variance of the variances themselves, over 1 + that: v^2 (1 - scatter) of an estimate v is right
  /// on average. largest_share where samples are independent; with replicates their number counts as well.
  double scatter = 0.0;
  double degrees = 0.0;  ///< of freedom of the variances; samples less one where they are independent
  /// Luminance that the mean would lose without the largest sample, and the variance of what is left.
  double of_largest = 0.0, variance_without = 0.0;
  bool known = false;  ///< the variances are valid: at least 2 samples, 33 of dependent ones
};
/// Of dependent samples, the variance of luminance is that of the replicates' means, and the variances of
/// the channels are in proportion to those of the single samples: the film keeps replicates of luminance.
[[nodiscard]] PixelStatistics pixel_statistics(const PixelSums& sums, SampleRelation relation);
[[nodiscard]] inline PixelStatistics pixel_statistics(const Film& film, std::size_t pixel) {
  return pixel_statistics(film.pixel(pixel), film.relation());
}

}  // namespace raykiln::render
