#include "raykiln/scheduler/judge_picture.hpp"

#include <algorithm>
#include <cmath>

#include "raykiln/accuracy/allocation.hpp"
#include "raykiln/accuracy/image_error.hpp"

namespace raykiln::server {
namespace {

static_assert(kErrorFloor == render::kSampleFloor);
static_assert(kAdaptiveTile == render::kCellSide);

constexpr std::uint64_t kLargestBlock = 16;  ///< samples
/// Steps of adaptive jobs, as a ratio of samples: small near the target, larger far from it, where a decision costs
/// as much and says nothing new. Small enough for what a cell is given not to hang on one noisy estimate.
constexpr double kLeastStep = 1.05, kMostStep = 1.25;

ErrorFigure figure(const render::Figure& f) { return {f.value, f.low, f.high}; }

PictureError as_shown(const render::ImageError& found, bool samples_area) {
  PictureError error;
  error.grade = name(found.grade);
  error.error = figure(found.error);
  error.rmse = figure(found.rmse);
  error.display_rmse = figure(found.display_rmse);
  error.heavy_tailed = found.heavy_tailed;
  error.notices = render::error_notices(found, samples_area);
  error.least_samples = found.least_samples;
  error.mean_samples = found.mean_samples;
  return error;
}

}  // namespace

PictureError judge_picture(const render::Film& film, bool samples_area) {
  return as_shown(render::image_error(film), samples_area);
}

Decision decide(const render::Film& film, const JobRequest& request) {
  Decision decision{judge_picture(film, request.pixel_mode == PixelMode::kRandom), {}};
  if (!request.adaptive || target_met(request.stop, decision.error)) return decision;
  // As many samples as are expected to reach the target, within bounds, where they help most; more if that moves no
  // cell by a block.
  const double ahead = request.stop.error ? decision.error.error.high / *request.stop.error : kMostStep;
  const double step = std::clamp(ahead * ahead, kLeastStep, kMostStep);
  auto mean = static_cast<std::uint64_t>(std::ceil(step * decision.error.mean_samples));
  const auto there = render::cell_samples(film);
  const auto cells = render::cell_noise(film);
  const int across = render::cells_across(film.width());
  const auto moves = [&] {
    for (std::size_t i = 0; i < there.size(); ++i) {
      const std::uint64_t wanted = decision.samples[i];
      if (wanted > there[i] && (wanted >= there[i] + kLargestBlock || wanted == request.stop.samples)) return true;
    }
    return false;
  };
  while (true) {
    decision.samples = render::place_samples(cells, across, static_cast<double>(mean), request.stop.samples);
    if (moves() || mean >= request.stop.samples) return decision;
    mean = next_decision(mean);
  }
}

void mark_adaptive(PictureError& error, const JobRequest& request) {
  if (request.adaptive) error.notices.emplace_back("adaptive");
}

PictureError look_at_picture(const render::Film& film, bool samples_area) {
  return as_shown(render::quick_image_error(film), samples_area);
}

}  // namespace raykiln::server
