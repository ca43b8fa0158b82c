// Rendering a scene and judging its mean against a known value.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "raykiln/render/render.hpp"

namespace raykiln::render::selftest {

/// What a check promised and found.
struct Outcome {
  bool passed = false;
  std::string measured;
};

/// The whole picture, all samples of all pixels.
struct Measured {
  double mean = 0.0;            ///< luminance over all pixels and samples
  double standard_error = 0.0;  ///< of the mean, from the spread of samples within pixels
  double samples = 0.0;         ///< that count
  double contributions = 0.0;   ///< lower bound of the samples that are not 0: sum over largest
  RenderStats stats;
  std::vector<double> pixels;   ///< mean luminance of each
};

[[nodiscard]] Film render_film(const Scene& scene, const RenderSettings& settings,
                               std::uint64_t samples, RenderStats* stats = nullptr,
                               const BuildParams& params = {});
[[nodiscard]] Measured measure(const Scene& scene, const RenderSettings& settings,
                               std::uint64_t samples);

/// |mean - truth| <= 4 standard errors + bias + 4u |truth|; false alarm 6.3e-5. Not accepted with
/// fewer than 30 contributions that are not 0, nor with a sample that was not finite.
[[nodiscard]] bool within_four_sigma(const Measured& measured, double truth, double bias = 0.0);

/// "0.45552 against 0.455528, 0.4 sigma".
[[nodiscard]] std::string against(const Measured& measured, double truth);

/// Judgement of a value that no chance enters.
[[nodiscard]] Outcome exact_to(const Measured& measured, double truth, double relative);
/// Judgement by within_four_sigma; `relative_bias` of the truth is allowed besides.
[[nodiscard]] Outcome statistically(const Measured& measured, double truth,
                                    double relative_bias = 0.0);

/// FNV-1a over the bits of all planes of a film.
[[nodiscard]] std::uint64_t bit_hash(const Film& film);

[[nodiscard]] std::string text(double value);

}  // namespace raykiln::render::selftest
