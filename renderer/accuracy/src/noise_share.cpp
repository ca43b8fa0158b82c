#include "noise_share.hpp"

#include <algorithm>
#include <cstddef>

namespace raykiln::render {

std::vector<double> noise_shares(const std::vector<double>& values,
                                 const std::vector<double>& variances, const Windows& windows) {
  std::vector<double> squares(values.size());
  std::transform(values.begin(), values.end(), squares.begin(), [](double v) { return v * v; });
  const auto sum = windows.sums(values), noise = windows.sums(variances);
  squares = windows.sums(squares);
  const auto counts = windows.counts();
  std::vector<double> shares(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double n = counts[i], mean = sum[i] / n;
    if (n < 2.0) continue;
    const double scatter = std::max(0.0, squares[i] / n - mean * mean) * n / (n - 1.0);
    shares[i] = n * scatter > noise[i] ? noise[i] / (n * scatter) : 1.0;
  }
  return shares;
}

}  // namespace raykiln::render
