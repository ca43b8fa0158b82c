// Random numbers as a pure function of (seed, pixel, sample, path node, bounce, dimension).
// No generator, no state, no order of consumption: a number that is not asked for shifts no other.
#pragma once

#include <cstdint>

#include "raykiln/sampling/sobol.hpp"

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
  kCoverage = 15,  ///< of a ray: behind how many of the surfaces that it meets it ends
  kCount = 16
};

/// How the samples of a pixel are spread over its random numbers.
enum class Sampler : std::uint8_t {
  kRandom,  ///< independently
  kSobol,   ///< in 4 replicates, each a scrambled Sobol' sequence by itself: see sobol.hpp
};

/// (seed, pixel, sample) mixed into 128 bits; of a sequence, all but the place in it, which stands apart.
struct PathKey {
  std::uint64_t a = 0, b = 0;
  SequencePoint point{};
};

/// A path key with path node and bounce mixed in.
struct VertexKey {
  std::uint64_t a = 0, b = 0;
  SequencePoint point{};
};

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

/// Samples of a replicate share their key and differ in their point. No sample index of the plain key
/// is as large as the complement of a replicate's number.
[[nodiscard]] inline PathKey path_key(Sampler sampler, std::uint64_t seed, std::uint64_t pixel,
                                      std::uint64_t sample) {
  if (sampler == Sampler::kRandom) return path_key(seed, pixel, sample);
  const SequencePlace place = sequence_place(sample);
  PathKey key = path_key(seed, pixel, ~place.sequence);
  key.point = place.point;
  return key;
}

/// `node` numbers the branch among those of the same bounce (0 while a hit shoots one ray).
[[nodiscard]] inline VertexKey vertex_key(const PathKey& path, std::uint64_t node,
                                          std::uint64_t bounce) {
  const std::uint64_t n = keyed::mix(path.b + node * keyed::kGolden, bounce * keyed::kRootTwo);
  return {keyed::mix(path.a + bounce * keyed::kGolden, n), keyed::mix(n + keyed::kRootTwo, path.a),
          path.point.at_vertex(bounce)};
}

[[nodiscard]] inline std::uint64_t random_bits(const VertexKey& vertex, Dimension dimension) {
  return keyed::mix(vertex.a + (static_cast<std::uint64_t>(dimension) + 1) * keyed::kGolden,
                    vertex.b);
}

/// Uniform in [0, 1), a multiple of 2^-53; never 1. Slots of a group (sobol::place_of) are the coordinates
/// of one point of a sequence; the points of other groups and vertices are randomised by themselves.
[[nodiscard]] inline double uniform(const VertexKey& vertex, Dimension dimension) {
  if (vertex.point.of_sequence()) {
    return sobol_number(vertex.a, vertex.b, vertex.point, static_cast<std::uint32_t>(dimension));
  }
  return static_cast<double>(random_bits(vertex, dimension) >> 11) * 0x1p-53;
}

}  // namespace raykiln::render
