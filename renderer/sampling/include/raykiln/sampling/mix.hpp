// Full-avalanche mixing of 64-bit words.
#pragma once

#include <cstdint>

namespace raykiln::render::keyed {

// Fractional bits of the golden ratio and of sqrt(2), odd: steps that visit all of 2^64.
inline constexpr std::uint64_t kGolden = 0x9E3779B97F4A7C15U;
inline constexpr std::uint64_t kRootTwo = 0x6A09E667F3BCC909U;

/// Stafford's "Mix13" finaliser (2011), the one of SplitMix64 (Steele, Lea & Flood 2014), with a
/// second word added between its two rounds. A bijection of `z` for every `word`.
constexpr std::uint64_t mix(std::uint64_t z, std::uint64_t word) {
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9U;
  z += word;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBU;
  return z ^ (z >> 31);
}

}  // namespace raykiln::render::keyed
