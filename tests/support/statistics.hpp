// Tests of hypotheses, for tests of samplers.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace raykiln::render::support {

/// Upper tail of the standard normal distribution.
inline double normal_tail(double z) { return 0.5 * std::erfc(z / std::sqrt(2.0)); }

/// P(chi^2 with k degrees of freedom > x), after Wilson & Hilferty (1931): good to 1e-3 for k >= 10.
inline double chi_square_tail(double x, double k) {
  const double third = std::cbrt(x / k);
  const double mean = 1.0 - 2.0 / (9.0 * k);
  return normal_tail((third - mean) / std::sqrt(2.0 / (9.0 * k)));
}

/// p-value of counts against expected counts; neighbouring cells are pooled until each expects 5.
inline double chi_square_p(const std::vector<double>& seen, const std::vector<double>& expected) {
  double chi2 = 0.0, pooled_seen = 0.0, pooled_expected = 0.0;
  int cells = 0;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    pooled_seen += seen[i];
    pooled_expected += expected[i];
    if (pooled_expected < 5.0) continue;
    chi2 += (pooled_seen - pooled_expected) * (pooled_seen - pooled_expected) / pooled_expected;
    ++cells;
    pooled_seen = pooled_expected = 0.0;
  }
  // What is left expects less than 5 together; samples there that nothing expects are a failure.
  if (pooled_expected <= 1e-9 && pooled_seen > 0.0) return 0.0;
  return cells > 1 ? chi_square_tail(chi2, cells - 1.0) : 1.0;
}

/// p-value of the Kolmogorov-Smirnov distance of `values` (sorted here) from a distribution.
template <typename Cdf>
double kolmogorov_smirnov_p(std::vector<double> values, Cdf cdf) {
  std::sort(values.begin(), values.end());
  const auto n = static_cast<double>(values.size());
  double distance = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double f = cdf(values[i]);
    distance = std::max({distance, f - static_cast<double>(i) / n,
                         (static_cast<double>(i) + 1.0) / n - f});
  }
  return std::min(1.0, 2.0 * std::exp(-2.0 * n * distance * distance));
}

/// Level of each of `tests` tests so that all together fail by chance with probability 0.01 (Sidak).
inline double sidak_level(double tests) { return 1.0 - std::pow(0.99, 1.0 / tests); }

}  // namespace raykiln::render::support
