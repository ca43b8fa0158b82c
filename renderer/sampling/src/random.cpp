#include "raykiln/sampling/random.hpp"

namespace raykiln::render {
namespace {

// Fractional bits of the golden ratio and of sqrt(2), odd: steps that visit all of 2^64.
constexpr std::uint64_t kGolden = 0x9E3779B97F4A7C15U;
constexpr std::uint64_t kRootTwo = 0x6A09E667F3BCC909U;

/// Stafford's "Mix13" finaliser (2011), the one of SplitMix64 (Steele, Lea & Flood 2014), with a
/// second word added between its two rounds. A bijection of `z` for every `word`.
constexpr std::uint64_t mix(std::uint64_t z, std::uint64_t word) {
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9U;
  z += word;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBU;
  return z ^ (z >> 31);
}

}  // namespace

// Every input goes through at least two full rounds on the way to each output word; feeding one
// input at a time keeps (pixel, sample) and (sample, pixel) apart.
PathKey path_key(std::uint64_t seed, std::uint64_t pixel, std::uint64_t sample) {
  const std::uint64_t s = mix(seed + kGolden, kRootTwo);
  const std::uint64_t p = mix(s ^ pixel, kGolden);
  const std::uint64_t a = mix(p + sample * kGolden, s);
  const std::uint64_t b = mix(a + kRootTwo, p ^ (sample * kRootTwo));
  return {a, b};
}

VertexKey vertex_key(const PathKey& path, std::uint64_t node, std::uint64_t bounce) {
  const std::uint64_t n = mix(path.b + node * kGolden, bounce * kRootTwo);
  return {mix(path.a + bounce * kGolden, n), mix(n + kRootTwo, path.a)};
}

std::uint64_t random_bits(const VertexKey& vertex, Dimension dimension) {
  return mix(vertex.a + (static_cast<std::uint64_t>(dimension) + 1) * kGolden, vertex.b);
}

}  // namespace raykiln::render
