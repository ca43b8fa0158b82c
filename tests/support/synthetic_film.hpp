// Films filled with samples of known distributions, for tests of error estimates.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "raykiln/image/film.hpp"

namespace raykiln::render::support {

/// SplitMix64 (Steele, Lea & Flood 2014): small, and good enough for tests.
class TestRandom {
 public:
  /// Streams of different seeds start far apart: the seed is mixed, not multiplied by the step.
  explicit TestRandom(std::uint64_t seed) : state_(seed) { state_ = bits() ^ (bits() << 1U); }
  std::uint64_t bits() {
    std::uint64_t z = (state_ += 0x9E3779B97F4A7C15ULL);
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBULL;
    return z ^ (z >> 31U);
  }
  double uniform() { return (static_cast<double>(bits() >> 11U) + 0.5) * 0x1p-53; }  ///< (0, 1)
  double exponential() { return -std::log(uniform()); }
  double normal() {
    return std::sqrt(2.0 * exponential()) * std::cos(2.0 * std::numbers::pi * uniform());
  }

 private:
  std::uint64_t state_;
};

/// A film with `samples` samples in every pixel; sample(x, y, random) gives one as Rgbd.
template <typename Sample>
Film synthetic_film(int width, int height, std::uint64_t samples, std::uint64_t seed, Sample sample) {
  Film film(width, height);
  TestRandom random(seed);
  for (const SampleBlock& block : blocks_for(samples)) {
    BlockResult result{.block = block, .planes = make_block_planes(static_cast<std::size_t>(width) *
                                                                   static_cast<std::size_t>(height))};
    std::size_t pixel = 0;
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x, ++pixel) {
        for (std::uint64_t i = 0; i < block.count; ++i) {
          add_sample(result.planes, pixel, sample(x, y, random), false);
        }
      }
    }
    film.fold({0, 0, width, height}, result);
  }
  return film;
}

/// truth(x, y) of every pixel, three channels, as PixelErrors has its means.
template <typename Truth>
std::vector<double> synthetic_truth(int width, int height, Truth truth) {
  std::vector<double> values;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const Rgbd value = truth(x, y);
      values.insert(values.end(), {value.x, value.y, value.z});
    }
  }
  return values;
}

}  // namespace raykiln::render::support
