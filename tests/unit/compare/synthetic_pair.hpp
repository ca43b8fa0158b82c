// Pictures made of independent samples of a known distribution, with their measured standard errors.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <random>

#include "raykiln/compare/measured_image.hpp"

namespace raykiln::render::synthetic {

using Random = std::mt19937_64;
/// One sample of a pixel's brightness; the channels get 1, 0.8 and 0.5 of it.
using Sample = std::function<double(Random&, int x, int y)>;

inline double exponential(Random& random) { return std::exponential_distribution<double>(1.0)(random); }

/// 0.1 and, once in 500 samples, a bright path that carries half of the light.
inline double rare_spike(Random& random) {
  return std::uniform_real_distribution<double>(0.0, 1.0)(random) < 0.002 ? 50.1 : 0.1;
}

/// Pareto with tail index 2: infinite variance.
inline double heavy_tail(Random& random) {
  return 1.0 / std::sqrt(1.0 - std::uniform_real_distribution<double>(0.0, 1.0)(random));
}

inline MeasuredImage measure(int width, int height, int samples, std::uint64_t seed, const Sample& sample) {
  Random random(seed);
  MeasuredImage image;
  image.mean = {.width = width, .height = height, .rgb = {}};
  const double n = samples;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      double mean = 0.0, squares = 0.0;
      for (int i = 0; i < samples; ++i) {
        const double value = sample(random, x, y), deviation = value - mean;
        mean += deviation / (i + 1);
        squares += deviation * (value - mean);
      }
      const double error = samples > 1 ? std::sqrt(squares / (n * (n - 1.0))) : 0.0;
      for (const double share : {1.0, 0.8, 0.5}) {
        image.mean.rgb.push_back(static_cast<float>(share * mean));
        image.error.push_back(static_cast<float>(share * error));
      }
      image.samples.push_back(static_cast<float>(samples));
    }
  }
  return image;
}

}  // namespace raykiln::render::synthetic
