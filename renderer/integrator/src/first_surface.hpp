// The layers of a sample: what its camera ray meets, and its light divided by the way that it came.
#pragma once

#include <span>

#include "path_stream.hpp"
#include "raykiln/image/layers.hpp"
#include "raykiln/integrator/path_tracer.hpp"
#include "transport.hpp"

namespace raykiln::render {

/// What a camera ray met. Its light is left at 0, but for `emission` where shadows of point lights are left
/// out: that light arrives with the emission of the surface then, and is told apart by this. `painted`: scratch.
[[nodiscard]] LayerSample first_surface(const Transport& transport, const CameraRays& camera, const Ray& ray,
                                        const Hit& hit, Material& painted);

/// After paths were shaded and their shadow rays traced, before any of their continuations: notes how much light
/// had arrived at the first surface (emission, direct) and one reflection further (indirect, until divide_light()).
void mark_light(const Transport& transport, std::span<const PathState> shaded, std::span<const PathResult> results,
                std::span<LayerSample> layers);

/// The three parts of finished paths. A part is a difference of sums that a path grew by, so it is exactly 0 where
/// nothing was added, and they add up to the radiance within the rounding of doubles.
void divide_light(std::span<const PathResult> results, std::span<LayerSample> layers);

}  // namespace raykiln::render
