// What paths need beside the scene, and what is made of it on the first demand.
#pragma once

#include <stop_token>

#include "raykiln/integrator/path_tracer.hpp"

namespace raykiln::render {

/// Makes what a PathTracer of these would make: smaller copies of textures, the tree of emitters; seconds for large ones.
/// False where stop was requested first. What was made is kept for the next who asks, by the scene.
[[nodiscard]] bool make_ready(const TransportScene& scene, const PathSettings& settings, const std::stop_token& stop);

}  // namespace raykiln::render
