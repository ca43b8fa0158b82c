// Random members of a class of inputs, from a seed that the table shows.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <string>

namespace raykiln::hard {

class Members {
 public:
  explicit Members(std::uint64_t seed) : seed_(seed), random_(seed) {}

  /// Uniform in [low, high).
  double between(double low, double high) {
    return low + (high - low) * 0x1p-53 * static_cast<double>(random_() >> 11);
  }
  /// Log-uniform in [low, high).
  double scale(double low, double high) { return std::exp(between(std::log(low), std::log(high))); }
  std::uint64_t bits() { return random_(); }

  [[nodiscard]] std::string note() const { return " (members from seed " + std::to_string(seed_) + ")"; }

 private:
  std::uint64_t seed_;
  std::mt19937_64 random_;
};

}  // namespace raykiln::hard
