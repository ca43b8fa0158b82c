// Layers of a film as pictures carry them, and as channels of an EXR.
#pragma once

#include <span>
#include <vector>

#include "raykiln/image/encode.hpp"
#include "raykiln/image/layers.hpp"
#include "raykiln/store/store.hpp"

namespace raykiln::server {

/// All layers of the film; none for null. `samples`: those that count, one a pixel.
[[nodiscard]] std::vector<StoredLayer> resolved(const render::LayerFilm* film, std::span<const float> samples);

/// Spans into `layer`, which outlives the plane.
[[nodiscard]] render::ExtraPlane exr_plane(const StoredLayer& layer);

}  // namespace raykiln::server
