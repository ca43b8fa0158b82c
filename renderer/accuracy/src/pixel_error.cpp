#include "raykiln/accuracy/pixel_error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "noise_share.hpp"
#include "pixel_statistics.hpp"
#include "windows.hpp"

namespace raykiln::render {
namespace {

constexpr int kWindowRadius = 1;
constexpr int kStripRows = 16;  ///< rows that are worked on at once: what they need stays near the processor

/// Variances of one channel, drawn to those of their windows. One sample of many that make up a
/// variance adds (share v) of it, so that the estimate scatters by share v^2.
std::vector<double> pooled(const std::vector<PixelStatistics>& pixels, std::size_t channel,
                           const Windows& windows, const std::vector<double>& counts) {
  std::vector<double> own(pixels.size()), scatter(pixels.size());
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    own[i] = pixels[i].variance[channel];
    scatter[i] = pixels[i].scatter * own[i] * own[i];
  }
  const auto shares = noise_shares(own, scatter, windows);
  const auto sums = windows.sums(own);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (pixels[i].known) own[i] += shares[i] * (sums[i] / counts[i] - own[i]);
  }
  return own;
}

/// `statistics` of each index.
template <typename Statistics>
PixelErrors errors_of(int columns, int rows, const Statistics& statistics) {
  const auto width = static_cast<std::size_t>(columns), pixels = width * static_cast<std::size_t>(rows);
  PixelErrors result{.width = columns,
                     .height = rows,
                     .mean = std::vector<double>(3 * pixels),
                     .standard_error = std::vector<double>(3 * pixels, std::numeric_limits<double>::quiet_NaN())};
  for (int y0 = 0; y0 < rows; y0 += kStripRows) {
    const int y1 = std::min(y0 + kStripRows, rows);
    // With as many rows around as windows reach.
    const int first = std::max(0, y0 - kWindowRadius), last = std::min(rows, y1 + kWindowRadius);
    const std::size_t offset = static_cast<std::size_t>(first) * width;
    std::vector<PixelStatistics> strip(static_cast<std::size_t>(last - first) * width);
    std::vector<double> known(strip.size());
    for (std::size_t i = 0; i < strip.size(); ++i) {
      strip[i] = statistics(offset + i);
      known[i] = strip[i].known ? 1.0 : 0.0;
    }
    const Windows windows{columns, last - first, kWindowRadius};
    known = windows.sums(known);  // how many of each window are
    for (std::size_t c = 0; c < 3; ++c) {
      const auto variances = pooled(strip, c, windows, known);
      for (std::size_t i = static_cast<std::size_t>(y0) * width; i < static_cast<std::size_t>(y1) * width; ++i) {
        const PixelStatistics& p = strip[i - offset];
        result.mean[3 * i + c] = p.mean[c];
        if (p.known) result.standard_error[3 * i + c] = std::sqrt(variances[i - offset]);
      }
    }
  }
  return result;
}

}  // namespace

PixelErrors pixel_errors(const Film& film) {
  return errors_of(film.width(), film.height(), [&](std::size_t i) { return pixel_statistics(film, i); });
}

PixelErrors pixel_errors(std::span<const PixelSums> pixels, int width, SampleRelation relation) {
  const int height = width > 0 ? static_cast<int>(pixels.size() / static_cast<std::size_t>(width)) : 0;
  return errors_of(width, height, [&](std::size_t i) { return pixel_statistics(pixels[i], relation); });
}

}  // namespace raykiln::render
