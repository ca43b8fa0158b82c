// Sums over pixels of expected squared errors, and how far the real ones may be from them.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "pixel_statistics.hpp"
#include "windows.hpp"

namespace raykiln::render {

struct Tally {
  double sum = 0.0;
  double variance = 0.0;  ///< of (real - estimated)
};

/// Expected squared errors of the channels of a pixel, and their standard deviations about that.
struct SquaredError {
  std::array<double, 3> mean{}, spread{};
  [[nodiscard]] double total() const { return mean[0] + mean[1] + mean[2]; }
};
/// Of one kind (relative, linear, display), one a pixel.
using SquaredErrors = std::vector<SquaredError>;

/// Adds the pixels of `core` in `errors`. With Y_i the n samples less their limit, the real square
/// less its estimate is (mean Y)^2 - s^2/n = sum over i != j of Y_i Y_j / (n (n - 1)): its variance is
/// 2 v^2 with v the true variance of the mean, whatever the distribution of the samples (`spread` then
/// is sqrt(2) v; what is not linear in the error says its own). v^2 is taken
/// as v^2 of the estimate less what its own scatter adds, or as its product with the mean v of the
/// 5 x 5 pixels around if that is larger: both are right where tails are heavy, when the square of the
/// estimate is many times too large. `correlation` is that of the noise of two channels.
void add(Tally& tally, const SquaredErrors& errors, std::span<const PixelStatistics> pixels,
         const Windows& windows, double correlation, const PixelRect& core);

}  // namespace raykiln::render
