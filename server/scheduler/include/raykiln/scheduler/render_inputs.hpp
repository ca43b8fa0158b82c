// From a job's request to what the renderer takes.
#pragma once

#include <stop_token>

#include "raykiln/base/result.hpp"
#include "raykiln/jobs/job_request.hpp"
#include "raykiln/jobs/job_snapshot.hpp"
#include "raykiln/render/render.hpp"
#include "raykiln/workers/scene_report.hpp"

namespace raykiln::server {

/// Whether the scene has the camera that is asked for ("invalid_request" at "/camera").
[[nodiscard]] Status check_camera(const CameraChoice& choice, const SceneReport& report);

/// Precondition: validate(request) is success. The camera is looked up in the scene.
[[nodiscard]] Result<render::RenderSettings> render_settings(const JobRequest& request,
                                                             const render::Scene& scene);

/// The renderer's word for what the request asks for.
[[nodiscard]] render::Sampler sampler_of(const JobRequest& request);

/// Bytes that a job's film, its picture and its layers take while it is active; saturates.
[[nodiscard]] std::uint64_t film_memory(const JobRequest& request);

/// Adds what the light model gets wrong in this scene ("heavy_tailed", "not_conserving_refraction"
/// at "/light_model"); nothing that is there already.
void warn_of_light_model(const render::RenderSettings& settings, const render::Scene& scene,
                         std::vector<JobWarning>& warnings);

/// Adds "deliberate_approximation" at "/effects" where something that the scene calls for is left out.
void warn_of_approximation(const EffectReport& report, std::vector<JobWarning>& warnings);

/// Adds what the tree and the sampling cannot help ("tree_no_benefit", "tree_budget_reached", "unresolved_sharp_highlight");
/// nothing that is there already.
void warn_of_picture(const render::RenderSettings& settings, const render::Scene& scene,
                     const render::BuildStats& tree, std::vector<JobWarning>& warnings);

/// Adds light that no number of samples brings, with its size ("truncated_paths" at "/max_depth",
/// "unseen_light" at "/emitter_sampling"), from a pilot of some ten milliseconds; none for default settings, or
/// where stop is requested while what paths need of the scene is made for it.
void warn_of_missing_light(const render::RenderSettings& settings, const render::PreparedScene& scene,
                           std::vector<JobWarning>& warnings, const std::stop_token& stop = {});

}  // namespace raykiln::server
