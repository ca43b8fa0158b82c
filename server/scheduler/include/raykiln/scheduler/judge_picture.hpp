// From the renderer's error figures to what a job keeps of them.
#pragma once

#include <cstdint>
#include <vector>

#include "raykiln/image/film.hpp"
#include "raykiln/jobs/picture_error.hpp"

namespace raykiln::server {

/// `samples_area`: the pixel mode samples the area of pixels, so that aliasing is part of the error.
[[nodiscard]] PictureError judge_picture(const render::Film& film, bool samples_area);

/// The same from a sample of the pixels of a large film: in milliseconds, with wider intervals.
[[nodiscard]] PictureError look_at_picture(const render::Film& film, bool samples_area);

/// At rest: the error, and where the samples of an adaptive job go next (one number a tile of kAdaptiveTile, row
/// by row; empty for others, and once the target is met).
struct Decision {
  PictureError error;
  std::vector<std::uint64_t> samples;
};
[[nodiscard]] Decision decide(const render::Film& film, const JobRequest& request);

/// A figure that is not of one number of samples everywhere says so.
void mark_adaptive(PictureError& error, const JobRequest& request);

}  // namespace raykiln::server
