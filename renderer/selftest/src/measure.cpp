#include "raykiln/selftest/measure.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <memory>

namespace raykiln::render::selftest {

std::string text(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.6g", value);
  return buffer;
}

Film render_film(const Scene& scene, const RenderSettings& settings, std::uint64_t samples,
                 RenderStats* stats, const BuildParams& params) {
  const auto shared = std::make_shared<const Scene>(scene);
  SerialTaskRunner runner;
  const auto prepared = prepare(shared, build_scene_tree(*shared, params, runner));
  const auto blocks = blocks_for(samples);
  Film film = make_film(settings);
  const auto result =
      render_tile(*prepared, settings, {0, 0, settings.width, settings.height}, blocks, {});
  merge(film, result);
  if (stats != nullptr) *stats = result.stats;
  return film;
}

// The error comes from the spread within pixels: differences between pixels are no noise.
Measured measure(const Scene& scene, const RenderSettings& settings, std::uint64_t samples) {
  Measured m;
  const Film film = render_film(scene, settings, samples, &m.stats);
  const auto beauty = film.plane("beauty"), counts = film.plane("samples"),
             moments = film.plane("luminance_moment"), largest = film.plane("largest");
  double sum = 0.0, variance = 0.0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const double y = luminance({beauty[3 * i], beauty[3 * i + 1], beauty[3 * i + 2]});
    sum += y;
    m.samples += counts[i];
    m.pixels.push_back(counts[i] > 0.0 ? y / counts[i] : 0.0);
    if (counts[i] > 1.0) variance += counts[i] * moments[i] / (counts[i] - 1.0);
    if (largest[i] > 0.0) m.contributions += std::ceil(y / largest[i] - 1e-6);
  }
  m.mean = sum / m.samples;
  m.standard_error = std::sqrt(variance) / m.samples;
  return m;
}

bool within_four_sigma(const Measured& m, double truth, double bias) {
  const double bound = 4.0 * m.standard_error + bias + 4.0 * 0x1p-24 * std::abs(truth);
  return m.stats.non_finite == 0 && m.contributions >= 30.0 && std::abs(m.mean - truth) <= bound;
}

std::string against(const Measured& m, double truth) {
  std::string line = text(m.mean) + " against " + text(truth);
  if (m.standard_error > 1e-7 * std::abs(truth)) {
    line += ", " + text((m.mean - truth) / m.standard_error) + " sigma of " + text(m.standard_error);
  } else {
    line += ", relative error " + text(m.mean / truth - 1.0);
  }
  return line;
}

Outcome exact_to(const Measured& m, double truth, double relative) {
  return {m.stats.non_finite == 0 && std::abs(m.mean - truth) <= relative * std::abs(truth),
          text(m.mean) + " against " + text(truth) + ", relative error " + text(m.mean / truth - 1.0)};
}

Outcome statistically(const Measured& m, double truth, double relative_bias) {
  return {within_four_sigma(m, truth, relative_bias * std::abs(truth)), against(m, truth)};
}

std::uint64_t bit_hash(const Film& film) {
  std::uint64_t hash = 0xCBF29CE484222325ULL;
  for (const PlaneSpec& spec : film_planes()) {
    for (const double value : film.plane(spec.name)) {
      const auto bits = std::bit_cast<std::uint64_t>(value);
      for (int shift = 0; shift < 64; shift += 8) {
        hash = (hash ^ ((bits >> shift) & 0xFFU)) * 0x100000001B3ULL;
      }
    }
  }
  return hash;
}

}  // namespace raykiln::render::selftest
