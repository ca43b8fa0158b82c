#include "raykiln/scheduler/judge_picture.hpp"

#include "raykiln/accuracy/image_error.hpp"

namespace raykiln::server {
namespace {

static_assert(kErrorFloor == render::kSampleFloor);

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

PictureError look_at_picture(const render::Film& film, bool samples_area) {
  return as_shown(render::quick_image_error(film), samples_area);
}

}  // namespace raykiln::server
