// Pictures of small scenes: their hash, mean and per-pixel estimates.
#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "hard/support/rules.hpp"
#include "raykiln/render/render.hpp"

namespace raykiln::hard {

struct Picture {
  std::uint64_t hash = 0;  ///< over the bits of all planes of the film
  double mean = 0.0;       ///< of all pixels and channels
  std::uint64_t non_finite = 0;
  render::RenderStats stats;
  std::vector<PixelEstimate> pixels;  ///< luminance
  std::vector<double> beauty;         ///< mean RGB a pixel
};

/// What a film shows.
inline Picture picture_of(const render::Film& film) {
  Picture result;
  std::vector<std::vector<double>> planes;
  for (const auto& spec : render::film_planes()) planes.push_back(film.plane(spec.name));
  result.hash = bit_hash(planes);
  const auto counts = film.plane("samples");
  const auto moments = film.plane("luminance_moment");
  result.beauty = film.plane("beauty");
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const double n = counts[i];
    for (std::size_t c = 0; c < 3; ++c) result.beauty[3 * i + c] /= n;
    const render::Rgbd rgb(result.beauty[3 * i], result.beauty[3 * i + 1], result.beauty[3 * i + 2]);
    result.pixels.push_back({render::luminance(rgb), n > 1.0 ? moments[i] / (n - 1.0) / n : 0.0});
    result.mean += (rgb.x + rgb.y + rgb.z) / 3.0 / static_cast<double>(counts.size());
  }
  return result;
}

/// Renders all samples of all pixels; the tiles are `tile` pixels wide and high.
inline Picture picture(const render::PreparedScene& scene, const render::RenderSettings& settings,
                       std::uint64_t samples, int tile = 1 << 20) {
  render::Film film = render::make_film(settings);
  render::RenderStats stats;
  const auto blocks = render::blocks_for(samples);
  for (int y = 0; y < settings.height; y += tile) {
    for (int x = 0; x < settings.width; x += tile) {
      const render::PixelRect rect{x, y, std::min(x + tile, settings.width),
                                   std::min(y + tile, settings.height)};
      const auto part = render::render_tile(scene, settings, rect, blocks, {});
      render::add(stats, part.stats);
      render::merge(film, part);
    }
  }
  Picture result = picture_of(film);
  result.stats = stats;
  result.non_finite = stats.non_finite;
  return result;
}

/// The scene with its tree, built on this thread.
inline std::shared_ptr<const render::PreparedScene> prepared(const render::Scene& scene,
                                                             const render::BuildParams& params = {}) {
  const auto shared = std::make_shared<const render::Scene>(scene);
  render::SerialTaskRunner runner;
  return render::prepare(shared, render::build_scene_tree(*shared, params, runner));
}

inline Picture picture(const render::Scene& scene, const render::RenderSettings& settings,
                       std::uint64_t samples, const render::BuildParams& params = {}) {
  return picture(*prepared(scene, params), settings, samples);
}

}  // namespace raykiln::hard
