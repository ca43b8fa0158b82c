#include "replicate_variance.hpp"

#include <algorithm>

namespace raykiln::render {

ReplicateVariance replicate_variance(const PixelSums& sums) {
  const auto n = static_cast<double>(sums.samples());
  double mean = 0.0, squared_shares = 0.0, spread = 0.0;
  for (std::size_t r = 0; r < kReplicates; ++r) {
    if (sums.luminance_count[r] == 0) continue;
    const double share = static_cast<double>(sums.luminance_count[r]) / n;
    if (share >= 0.5) return {};
    mean += sums.luminance_sum[r] / n;
    squared_shares += share * share;
    spread += share * share / (1.0 - 2.0 * share);
  }
  if (!(spread > 0.0)) return {};
  ReplicateVariance result{.degrees = std::max(1.0, 1.0 / squared_shares - 1.0)};
  for (std::size_t r = 0; r < kReplicates; ++r) {
    if (sums.luminance_count[r] == 0) continue;
    const auto count = static_cast<double>(sums.luminance_count[r]);
    const double share = count / n, deviation = sums.luminance_sum[r] / count - mean;
    result.variance += share * share / (1.0 - 2.0 * share) / (1.0 + spread) * deviation * deviation;
  }
  return result;
}

}  // namespace raykiln::render
