// From the renderer's error figures to what a job keeps of them.
#pragma once

#include "raykiln/image/film.hpp"
#include "raykiln/jobs/picture_error.hpp"

namespace raykiln::server {

/// `samples_area`: the pixel mode samples the area of pixels, so that aliasing is part of the error.
[[nodiscard]] PictureError judge_picture(const render::Film& film, bool samples_area);

/// The same from a sample of the pixels of a large film: in milliseconds, with wider intervals.
[[nodiscard]] PictureError look_at_picture(const render::Film& film, bool samples_area);

}  // namespace raykiln::server
