#include "raykiln/accuracy/pixel_error.hpp"

#include <cmath>
#include <limits>

#include "noise_share.hpp"
#include "pixel_statistics.hpp"
#include "windows.hpp"

namespace raykiln::render {
namespace {

constexpr int kWindowRadius = 1;

std::size_t pixels_of(const Film& film) {
  return static_cast<std::size_t>(film.width()) * static_cast<std::size_t>(film.height());
}

/// Variances of one channel, drawn to those of their windows. One sample of many that make up a
/// variance adds (share v) of it, so that the estimate scatters by share v^2.
std::vector<double> pooled(const std::vector<PixelStatistics>& pixels, std::size_t channel,
                           const Windows& windows) {
  std::vector<double> own(pixels.size()), scatter(pixels.size()), known(pixels.size());
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    own[i] = pixels[i].variance[channel];
    scatter[i] = pixels[i].largest_share * own[i] * own[i];
    known[i] = pixels[i].known ? 1.0 : 0.0;
  }
  const auto shares = noise_shares(own, scatter, windows);
  const auto sums = windows.sums(own), counts = windows.sums(known);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (pixels[i].known) own[i] += shares[i] * (sums[i] / counts[i] - own[i]);
  }
  return own;
}

}  // namespace

PixelErrors pixel_errors(const Film& film) {
  const std::size_t pixels = pixels_of(film);
  PixelErrors result{.width = film.width(),
                     .height = film.height(),
                     .mean = std::vector<double>(3 * pixels),
                     .standard_error = std::vector<double>(3 * pixels, std::numeric_limits<double>::quiet_NaN())};
  std::vector<PixelStatistics> statistics(pixels);
  for (std::size_t i = 0; i < pixels; ++i) statistics[i] = pixel_statistics(film.pixel(i));
  for (std::size_t c = 0; c < 3; ++c) {
    const auto variances = pooled(statistics, c, {film.width(), film.height(), kWindowRadius});
    for (std::size_t i = 0; i < pixels; ++i) {
      result.mean[3 * i + c] = statistics[i].mean[c];
      if (statistics[i].known) result.standard_error[3 * i + c] = std::sqrt(variances[i]);
    }
  }
  return result;
}

}  // namespace raykiln::render
