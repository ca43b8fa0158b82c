#include "pixel_statistics.hpp"

#include <algorithm>

#include "raykiln/math/vec.hpp"
#include "replicate_variance.hpp"

namespace raykiln::render {
namespace {

/// Deviations below this part of the mean are rounding of equal samples, whose means are sums divided.
constexpr double kRounding = 1e-13;

/// A sum of squared deviations as the variance of the mean.
double variance_of_mean(double moment, double mean, double n) {
  const double rounding = kRounding * mean;
  return moment <= n * rounding * rounding ? 0.0 : moment / (n * (n - 1.0));
}

void judge_largest(PixelStatistics& result, const PixelSums& sums) {
  const auto n = static_cast<double>(result.samples);
  const double above = std::max(0.0, sums.largest - result.luminance);
  result.largest_share = std::min(1.0, above * above / sums.luminance_moment);
  if (result.samples < 3) return;
  const double left = sums.luminance_moment - above * above * n / (n - 1.0);
  result.of_largest = above / (n - 1.0);
  result.variance_without = std::max(0.0, left) / ((n - 1.0) * (n - 2.0));
}

/// What `result` says of independent samples becomes what the replicates say.
void judge_replicates(PixelStatistics& result, const PixelSums& sums) {
  const ReplicateVariance found = replicate_variance(sums);
  result.known = found.degrees > 0.0;
  result.degrees = found.degrees;
  if (!(result.luminance_variance > 0.0)) return;  // no two samples differ
  const double ratio = result.known ? found.variance / result.luminance_variance : 0.0;
  for (double& variance : result.variance) variance *= ratio;
  result.variance_without *= ratio;
  result.luminance_variance *= ratio;
  const double relative = 2.0 / std::max(1.0, found.degrees) + result.largest_share;
  result.scatter = relative / (1.0 + relative);
}

}  // namespace

PixelStatistics pixel_statistics(const PixelSums& sums, SampleRelation relation) {
  PixelStatistics result;
  result.samples = sums.samples();
  if (result.samples == 0) return result;
  const auto n = static_cast<double>(result.samples);
  for (std::size_t c = 0; c < 3; ++c) result.mean[c] = sums.beauty[c] / n;
  result.luminance = luminance({result.mean[0], result.mean[1], result.mean[2]});
  if (result.samples < 2) return result;
  result.known = true;
  result.degrees = n - 1.0;
  for (std::size_t c = 0; c < 3; ++c) {
    result.variance[c] = variance_of_mean(sums.moment[c], result.mean[c], n);
  }
  result.luminance_variance = variance_of_mean(sums.luminance_moment, result.luminance, n);
  result.variance_without = result.luminance_variance;
  if (result.luminance_variance > 0.0) judge_largest(result, sums);
  result.scatter = result.largest_share;
  if (relation == SampleRelation::kByReplicates) judge_replicates(result, sums);
  return result;
}

}  // namespace raykiln::render
