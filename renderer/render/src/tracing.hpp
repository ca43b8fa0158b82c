// From settings to what the integrator takes; shared by tiles and single samples.
#pragma once

#include "prepared_scene.hpp"
#include "raykiln/integrator/path_tracer.hpp"
#include "raykiln/render/render.hpp"

namespace raykiln::render {

[[nodiscard]] PathSettings path_settings(const PreparedScene& scene,
                                         const RenderSettings& settings);
[[nodiscard]] CameraRays camera_rays(const PreparedScene& scene, const RenderSettings& settings);

}  // namespace raykiln::render
