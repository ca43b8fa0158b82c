// The layers of a picture, from its film.
#pragma once

#include <vector>

#include "raykiln/scheduler/views.hpp"

namespace raykiln::server {

/// Fills error, samples and seconds. `seconds`: of workers, one a pixel.
void add_layers(JobImage& image, const render::Film& film, const std::vector<float>& seconds);

}  // namespace raykiln::server
