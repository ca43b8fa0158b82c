// From settings to what the integrator takes; shared by tiles and single samples.
#pragma once

#include <stop_token>

#include "prepared_scene.hpp"
#include "raykiln/integrator/path_tracer.hpp"
#include "raykiln/render/render.hpp"

namespace raykiln::render {

[[nodiscard]] PathSettings path_settings(const PreparedScene& scene,
                                         const RenderSettings& settings);
/// Makes what paths of these settings need of the scene, if no one has; false once stop is requested.
[[nodiscard]] bool make_ready(const PreparedScene& scene, const RenderSettings& settings, const std::stop_token& stop);
[[nodiscard]] CameraRays camera_rays(const PreparedScene& scene, const RenderSettings& settings);

/// What paths are traced through. Lives as long as `scene`.
[[nodiscard]] TransportScene transport_scene(const PreparedScene& scene);

}  // namespace raykiln::render
