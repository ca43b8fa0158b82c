// What one must know about float rounding: neighbours, error bounds, ordered keys.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace raykiln::render {

/// Rounding unit u = 2^-24 of float32.
inline constexpr double kFloatUnit = 0x1p-24;

/// gamma_n = n u / (1 - n u): relative error bound of n float operations in a row
/// (Higham 2002, lemma 3.1).
[[nodiscard]] constexpr double gamma_bound(int n) {
  return n * kFloatUnit / (1.0 - n * kFloatUnit);
}

[[nodiscard]] inline float next_up(float x) {
  return std::nextafterf(x, std::numeric_limits<float>::infinity());
}
[[nodiscard]] inline float next_down(float x) {
  return std::nextafterf(x, -std::numeric_limits<float>::infinity());
}

/// Nearest float not above / not below a double.
[[nodiscard]] inline float round_down(double x) {
  const auto f = static_cast<float>(x);
  return static_cast<double>(f) > x ? next_down(f) : f;
}
[[nodiscard]] inline float round_up(double x) {
  const auto f = static_cast<float>(x);
  return static_cast<double>(f) < x ? next_up(f) : f;
}

/// Monotone map of finite floats to unsigned integers; -0 and +0 map to the same key.
[[nodiscard]] inline std::uint32_t ordered_key(float x) {
  const auto bits = std::bit_cast<std::uint32_t>(x + 0.0F);
  return (bits & 0x80000000U) != 0 ? ~bits : bits | 0x80000000U;
}

}  // namespace raykiln::render
