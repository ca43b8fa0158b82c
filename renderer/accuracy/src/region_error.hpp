// The expected squared errors of the pixels of a part of a film.
#pragma once

#include <cstdint>

#include "pixel_statistics.hpp"
#include "raykiln/image/film.hpp"
#include "tally.hpp"

namespace raykiln::render {

/// First look, pixel by pixel: counts, the mean, and how far the noise of the channels goes together.
class Survey {
 public:
  void add(const PixelStatistics& pixel);

  std::uint64_t pixels = 0, unsampled = 0, unknown = 0, least = UINT64_MAX;
  [[nodiscard]] double samples() const { return samples_ / static_cast<double>(pixels); }  ///< a pixel
  [[nodiscard]] double mean() const { return mean_ / (3.0 * static_cast<double>(pixels)); }
  [[nodiscard]] bool varies() const { return variance_ > 0.0; }
  /// 0.01 M^2: what is added to the squares that errors are divided by.
  [[nodiscard]] double floor() const { return 0.01 * mean() * mean(); }
  /// Of the noise of two channels: Var(Y) = sum w_c^2 v_c + rho sum of 2 w_c w_d sqrt(v_c v_d), solved for rho.
  [[nodiscard]] double correlation() const;

 private:
  double samples_ = 0.0, mean_ = 0.0, variance_ = 0.0;
  double luminance_variance_ = 0.0, apart_ = 0.0, together_ = 0.0;
};

/// What is added up over a picture.
struct Totals {
  Tally relative, linear, display;
  double tails = 0.0;  ///< relative squares in pixels about which too few samples speak
};

/// Rows and columns around a region that its figures depend on: squared errors of the windows' pixels need windows
/// of their own. With half of it the figures are the same, and the windows that intervals take their
/// neighbours' errors from are cut.
inline constexpr int kRegionMargin = 4;

/// Adds the pixels of `core`, judged with up to `margin` more around; `gain` is for display values.
void add_region(Totals& totals, const Film& film, const PixelRect& core, int margin, const Survey& survey, double gain);

/// Relative squares of the noise of one sample, as `Totals::relative` has them for the mean of all, summed over the core's pixels and
/// channels; and the variance of that sum, as far as its samples tell.
struct NoiseSum {
  double value = 0.0, variance = 0.0;
};
[[nodiscard]] NoiseSum noise_of_one_sample(const Film& film, const PixelRect& core, double floor);

}  // namespace raykiln::render
