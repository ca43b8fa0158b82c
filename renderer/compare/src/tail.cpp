#include "tail.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace raykiln::render {

double normal_two_sided(double z) { return std::erfc(std::abs(z) / std::numbers::sqrt2); }

double sign_sum_two_sided(double z) {
  static const double kConstant = 1.0 / (2.0 * std::erfc(1.0));  // P(N >= sqrt 2) = erfc(1) / 2
  return std::min(1.0, kConstant * normal_two_sided(z));
}

double sign_sum_quantile(double chance) {
  double low = 0.0, high = 40.0;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (sign_sum_two_sided(middle) > chance ? low : high) = middle;
  }
  return high;
}

double chi_square_above(double ratio, double degrees) {
  const double spread = 2.0 / (9.0 * degrees);
  const double z = (std::cbrt(ratio) - (1.0 - spread)) / std::sqrt(spread);
  return 0.5 * std::erfc(z / std::numbers::sqrt2);
}

}  // namespace raykiln::render
