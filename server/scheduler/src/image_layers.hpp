// The layers of a picture, from its film.
#pragma once

#include <vector>

#include "raykiln/scheduler/views.hpp"

namespace raykiln::server {

/// Fills error, samples, seconds and layers. `seconds`: of workers, one a pixel. `layers`: null for none.
void add_layers(JobImage& image, const render::Film& film, const render::LayerFilm* layers,
                const std::vector<float>& seconds);

}  // namespace raykiln::server
