// Pictures whose noise is unknown: thresholds, as image tools have them. Noise is not taken into account.
#pragma once

#include <cstdint>

#include "raykiln/image/film.hpp"

namespace raykiln::render {

/// A channel value fails if |a - b| > absolute and |a - b| > relative * max(|a|, |b|).
struct Thresholds {
  double absolute = 0.01;
  double relative = 0.05;
  double failing_share = 0.001;  ///< of pixels that may fail, [0, 1]
  double hard_limit = 1e300;     ///< no channel may differ by more than this, even in one pixel
};

struct ThresholdVerdict {
  bool differs = false;
  std::uint64_t failing_pixels = 0;
  double failing_share = 0.0;
  double largest = 0.0;  ///< |a - b|, with its place
  int x = 0, y = 0;
  std::uint64_t unlike_not_finite = 0;  ///< pixels that are finite in one picture alone: they fail
};

/// Both must have the same size (precondition).
[[nodiscard]] ThresholdVerdict test_thresholds(const Image& render, const Image& reference,
                                               const Thresholds& thresholds);

/// Figures that say how far apart two pictures are, whatever the reason. Non-finite pixels are left out.
struct DifferenceFigures {
  double mean_render = 0.0, mean_reference = 0.0;  ///< over pixels and channels
  double mean_absolute = 0.0;
  double rmse = 0.0;
  double largest = 0.0;
  double psnr_db = 0.0;  ///< against a peak of 1; 999 for equal pictures
  /// mean of (a - b)^2 / (b^2 + 0.01 mean(b)^2) over pixels and channels, b the reference
  double relmse = 0.0;
};
[[nodiscard]] DifferenceFigures difference_figures(const Image& render, const Image& reference);

}  // namespace raykiln::render
