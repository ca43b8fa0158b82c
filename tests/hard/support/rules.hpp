// The statistical rules that the hard cases are judged by.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace raykiln::hard {

inline constexpr double kUnit = 0x1p-24;  ///< rounding unit of float32
inline constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// R1: relative difference of a deterministic value.
inline double relative_error(double value, double truth) {
  return std::abs(value - truth) / std::abs(truth);
}

enum class Verdict { kAccepted, kRejected, kInconclusive };

/// Mean and spread of samples, by Welford's updates.
struct Samples {
  std::uint64_t n = 0, non_zero = 0;
  double mean = 0.0, squares = 0.0;

  void add(double x) {
    ++n;
    non_zero += x != 0.0 ? 1 : 0;
    const double delta = x - mean;
    mean += delta / static_cast<double>(n);
    squares += delta * (x - mean);
  }
  /// s / sqrt(n); infinite for fewer than two samples, whose error is unknown.
  [[nodiscard]] double standard_error() const {
    if (n < 2) return kInfinite;
    const auto count = static_cast<double>(n);
    return std::sqrt(squares / (count - 1.0) / count);
  }
};

/// R2: |mean - truth| <= 4 s/sqrt(n) + bias + 4 u |truth|. Fewer than 30 contributions other than
/// zero decide nothing. False alarm: 6.3e-5.
inline Verdict within_four_sigma(const Samples& samples, double truth, double bias = 0.0) {
  if (samples.non_zero < 30) return Verdict::kInconclusive;
  const double bound = 4.0 * samples.standard_error() + bias + 4.0 * kUnit * std::abs(truth);
  return std::abs(samples.mean - truth) <= bound ? Verdict::kAccepted : Verdict::kRejected;
}

/// R3: upper 95 % bound of the rate when `events` = 0 were seen in n trials (rule of three).
inline double rate_bound(std::uint64_t n) { return 3.0 / static_cast<double>(n); }

/// A pixel as R5 sees it: mean and the variance of that mean.
struct PixelEstimate {
  double mean = 0.0, variance_of_mean = 0.0;
};

struct ImageComparison {
  double accepted_share = 0.0;  ///< pixels within the Sidak band
  double mean_z = 0.0;          ///< difference of the global means in standard errors
  [[nodiscard]] bool equal() const { return accepted_share >= 0.9975 && std::abs(mean_z) <= 4.0; }
};

/// |z| that one of `tests` normal variables exceeds with probability `alpha` (Sidak), by bisection.
inline double sidak_z(double tests, double alpha = 0.01) {
  const double level = -std::expm1(std::log1p(-alpha) / tests);
  double lo = 0.0, hi = 40.0;
  for (int i = 0; i < 200; ++i) {
    const double z = 0.5 * (lo + hi);
    (std::erfc(z / std::sqrt(2.0)) > level ? lo : hi) = z;
  }
  return hi;
}

/// R5: per-pixel z-test with Sidak's correction, and the global mean (which alone sees a small
/// uniform bias). Pixels without variance on either side must be equal to 4 u.
inline ImageComparison compare_images(std::span<const PixelEstimate> a,
                                      std::span<const PixelEstimate> b) {
  const double band = sidak_z(static_cast<double>(a.size()));
  double difference = 0.0, variance = 0.0, magnitude = 0.0;
  std::size_t accepted = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double d = a[i].mean - b[i].mean;
    const double v = a[i].variance_of_mean + b[i].variance_of_mean;
    const double rounding = 4.0 * kUnit * std::max(std::abs(a[i].mean), std::abs(b[i].mean));
    accepted += std::abs(d) <= band * std::sqrt(v) + rounding ? 1U : 0U;
    difference += d;
    variance += v;
    magnitude += rounding;
  }
  ImageComparison result;
  result.accepted_share =
      a.empty() ? 0.0 : static_cast<double>(accepted) / static_cast<double>(a.size());
  const double beyond = std::max(0.0, std::abs(difference) - magnitude);
  result.mean_z = variance > 0.0 ? std::copysign(beyond / std::sqrt(variance), difference)
                                 : (beyond > 0.0 ? kInfinite : 0.0);
  return result;
}

/// R6: FNV-1a over the bits of all planes, in order. Equal numbers with other bits differ (-0, +0).
inline std::uint64_t bit_hash(std::span<const std::vector<double>> planes) {
  std::uint64_t hash = 0xCBF29CE484222325ULL;
  for (const std::vector<double>& plane : planes) {
    for (const double value : plane) {
      unsigned char bytes[sizeof value];
      std::memcpy(bytes, &value, sizeof value);
      for (const unsigned char byte : bytes) hash = (hash ^ byte) * 0x100000001B3ULL;
    }
  }
  return hash;
}

}  // namespace raykiln::hard
