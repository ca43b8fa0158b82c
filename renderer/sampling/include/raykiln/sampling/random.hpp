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
  kSpare0 = 13,
  kSpare1 = 14,
  kSpare2 = 15,
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

[[nodiscard]] PathKey path_key(std::uint64_t seed, std::uint64_t pixel, std::uint64_t sample);

/// `node` numbers the branch among those of the same bounce (0 while a hit shoots one ray).
[[nodiscard]] VertexKey vertex_key(const PathKey& path, std::uint64_t node, std::uint64_t bounce);

[[nodiscard]] std::uint64_t random_bits(const VertexKey& vertex, Dimension dimension);

/// Uniform in [0, 1), a multiple of 2^-53; never 1.
[[nodiscard]] inline double uniform(const VertexKey& vertex, Dimension dimension) {
  return static_cast<double>(random_bits(vertex, dimension) >> 11) * 0x1p-53;
}

}  // namespace raykiln::render
