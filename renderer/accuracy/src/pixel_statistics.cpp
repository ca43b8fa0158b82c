#include "pixel_statistics.hpp"

#include <algorithm>

#include "raykiln/math/vec.hpp"

namespace raykiln::render {
namespace {

/// Variance of the mean from independent replicates of unequal length n_r:
/// sum n_r (m_r - m)^2 / ((R - 1) n), whose expectation is sigma^2 / n.
double variance_of_replicates(const PixelSums& sums, double mean, double n) {
  double squares = 0.0;
  int replicates = 0;
  for (std::size_t r = 0; r < kReplicates; ++r) {
    const double n_r = sums.luminance_count[r];
    if (n_r == 0.0) continue;
    const double deviation = sums.luminance_sum[r] / n_r - mean;
    squares += n_r * deviation * deviation;
    ++replicates;
  }
  return replicates < 2 ? 0.0 : squares / ((replicates - 1) * n);
}

/// Deviations below this part of the mean are rounding of equal samples, whose means are sums divided.
constexpr double kRounding = 1e-13;

/// A sum of squared deviations as the variance of the mean.
double variance_of_mean(double moment, double mean, double n) {
  const double rounding = kRounding * mean;
  return moment <= n * rounding * rounding ? 0.0 : moment / (n * (n - 1.0));
}

/// Sums of windows along one row or column. Each is added up anew: a running difference would keep
/// the rounding of what has passed.
template <typename In, typename Out>
void slide(int length, int radius, In in, Out out) {
  for (int i = 0; i < length; ++i) {
    double sum = 0.0;
    for (int k = std::max(0, i - radius); k <= std::min(length - 1, i + radius); ++k) sum += in(k);
    out(i) = sum;
  }
}

}  // namespace

PixelStatistics pixel_statistics(const PixelSums& sums) {
  PixelStatistics result;
  result.samples = sums.samples();
  if (result.samples == 0) return result;
  const auto n = static_cast<double>(result.samples);
  for (std::size_t c = 0; c < 3; ++c) result.mean[c] = sums.beauty[c] / n;
  result.luminance = luminance({result.mean[0], result.mean[1], result.mean[2]});
  if (result.samples < 2) return result;
  result.known = true;
  for (std::size_t c = 0; c < 3; ++c) {
    result.variance[c] = variance_of_mean(sums.moment[c], result.mean[c], n);
  }
  result.luminance_variance = variance_of_mean(sums.luminance_moment, result.luminance, n);
  const double above = sums.largest - result.luminance;
  if (result.luminance_variance > 0.0) {
    result.largest_share = std::min(1.0, above * above / sums.luminance_moment);
  }
  result.replicate_variance = variance_of_replicates(sums, result.luminance, n);
  return result;
}

std::vector<double> window_sums(const std::vector<double>& values, int width, int height,
                                int radius) {
  const auto w = static_cast<std::size_t>(width);
  std::vector<double> rows(values.size()), result(values.size());
  for (std::size_t y = 0; y < static_cast<std::size_t>(height); ++y) {
    slide(
        width, radius, [&](int x) { return values[y * w + static_cast<std::size_t>(x)]; },
        [&](int x) -> double& { return rows[y * w + static_cast<std::size_t>(x)]; });
  }
  for (std::size_t x = 0; x < w; ++x) {
    slide(
        height, radius, [&](int y) { return rows[static_cast<std::size_t>(y) * w + x]; },
        [&](int y) -> double& { return result[static_cast<std::size_t>(y) * w + x]; });
  }
  return result;
}

}  // namespace raykiln::render
