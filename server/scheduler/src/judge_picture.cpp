#include "raykiln/scheduler/judge_picture.hpp"

#include "raykiln/accuracy/image_error.hpp"

namespace raykiln::server {
namespace {

static_assert(kErrorFloor == render::kSampleFloor);

ErrorFigure figure(const render::Figure& f) { return {f.value, f.low, f.high}; }

}  // namespace

PictureError judge_picture(const render::Film& film, bool samples_area) {
  const render::ImageError found = render::image_error(film);
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

}  // namespace raykiln::server
