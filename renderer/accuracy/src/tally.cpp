#include "tally.hpp"

#include <algorithm>

namespace raykiln::render {
namespace {

/// Relative variance of the sum over channels whose noise has this correlation.
double relative_variance(const SquaredError& e, double correlation) {
  const auto& s = e.spread;
  const double own = s[0] * s[0] + s[1] * s[1] + s[2] * s[2], together = s[0] + s[1] + s[2];
  const double sum = e.total();
  return (own + correlation * correlation * (together * together - own)) / (sum * sum);
}

}  // namespace

void add(Tally& tally, const SquaredErrors& errors, std::span<const PixelStatistics> pixels,
         const Windows& windows, double correlation, const PixelRect& core) {
  std::vector<double> sums(errors.size());
  std::transform(errors.begin(), errors.end(), sums.begin(), [](const SquaredError& e) { return e.total(); });
  const std::vector<double> others = windows.means_of_others(sums);
  windows.each(core, [&](std::size_t i) {
    if (!(sums[i] > 0.0)) return;
    const double square = sums[i] * std::max(others[i], sums[i] * (1.0 - pixels[i].scatter));
    tally.sum += sums[i];
    tally.variance += relative_variance(errors[i], correlation) * square * (1.0 + 1.0 / pixels[i].degrees);
  });
}

}  // namespace raykiln::render
