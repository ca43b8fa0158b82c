#include "raykiln/scheduler/judge_picture.hpp"

#include "raykiln/accuracy/allocation.hpp"
#include "raykiln/accuracy/image_error.hpp"

namespace raykiln::server {
namespace {

static_assert(kErrorFloor == render::kSampleFloor);
static_assert(kAdaptiveTile == render::kCellSide);

constexpr std::uint64_t kLargestBlock = 16;  ///< samples

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
  // A tenth more samples than the picture has, where they help most; more if that moves no cell by a block.
  auto mean = static_cast<std::uint64_t>(decision.error.mean_samples);
  const auto there = render::cell_samples(film);
  const auto moves = [&] {
    for (std::size_t i = 0; i < there.size(); ++i) {
      const std::uint64_t wanted = decision.samples[i];
      if (wanted > there[i] && (wanted >= there[i] + kLargestBlock || wanted == request.stop.samples)) return true;
    }
    return false;
  };
  do {
    mean = next_decision(mean);
    decision.samples = render::allocate_samples(film, static_cast<double>(mean), request.stop.samples);
  } while (!moves() && mean < request.stop.samples);
  return decision;
}

void mark_adaptive(PictureError& error, const JobRequest& request) {
  if (request.adaptive) error.notices.emplace_back("adaptive");
}

PictureError look_at_picture(const render::Film& film, bool samples_area) {
  return as_shown(render::quick_image_error(film), samples_area);
}

}  // namespace raykiln::server
