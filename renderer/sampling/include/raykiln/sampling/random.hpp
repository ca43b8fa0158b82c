// Random numbers as a pure function of (seed, pixel, sample, path node, bounce, dimension).
// No generator, no state, no order of consumption: a number that is not asked for shifts no other.
#pragma once

#include <cstdint>

namespace raykiln::render {

/// What a number at a vertex is for. Slots are never renumbered, so that an effect that is absent
/// consumes nothing and one that is added later changes no number of the others.
enum class Dimension : std::uint32_t {
  kPixelX = 0,
  kPixelY = 1,
  kLensX = 2,
  kLensY = 3,
  kLobeChoice = 4,     ///< diffuse or specular
  kFresnelChoice = 5,  ///< the side of the surface: reflected or transmitted
  kDirectionU = 6,
  kDirectionV = 7,
  kLightKindChoice = 8,
  kLightChoice = 9,
  kLightU = 10,
  kLightV = 11,
  kRoulette = 12,
  kEnvironmentU = 13,
  kEnvironmentV = 14,
  kSpare = 15,
  kCount = 16
};

/// All of (seed, pixel, sample) mixed into 128 bits.
struct PathKey {
  std::uint64_t a = 0, b = 0;
};

/// A path key with path node and bounce mixed in.
struct VertexKey {
  std::uint64_t a = 0, b = 0;
};

namespace keyed {

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

}  // namespace keyed

// Every input goes through at least two full rounds on the way to each output word; feeding one
// input at a time keeps (pixel, sample) and (sample, pixel) apart.
[[nodiscard]] inline PathKey path_key(std::uint64_t seed, std::uint64_t pixel,
                                      std::uint64_t sample) {
  const std::uint64_t s = keyed::mix(seed + keyed::kGolden, keyed::kRootTwo);
  const std::uint64_t p = keyed::mix(s ^ pixel, keyed::kGolden);
  const std::uint64_t a = keyed::mix(p + sample * keyed::kGolden, s);
  const std::uint64_t b = keyed::mix(a + keyed::kRootTwo, p ^ (sample * keyed::kRootTwo));
  return {a, b};
}

/// `node` numbers the branch among those of the same bounce (0 while a hit shoots one ray).
[[nodiscard]] inline VertexKey vertex_key(const PathKey& path, std::uint64_t node,
                                          std::uint64_t bounce) {
  const std::uint64_t n = keyed::mix(path.b + node * keyed::kGolden, bounce * keyed::kRootTwo);
  return {keyed::mix(path.a + bounce * keyed::kGolden, n), keyed::mix(n + keyed::kRootTwo, path.a)};
}

[[nodiscard]] inline std::uint64_t random_bits(const VertexKey& vertex, Dimension dimension) {
  return keyed::mix(vertex.a + (static_cast<std::uint64_t>(dimension) + 1) * keyed::kGolden,
                    vertex.b);
}

/// Uniform in [0, 1), a multiple of 2^-53; never 1.
[[nodiscard]] inline double uniform(const VertexKey& vertex, Dimension dimension) {
  return static_cast<double>(random_bits(vertex, dimension) >> 11) * 0x1p-53;
}

}  // namespace raykiln::render
