// A whole job in this process: import, tree, tiles on the pool, film.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "raykiln/app/progress.hpp"
#include "raykiln/app/scene_package.hpp"
#include "raykiln/image/film.hpp"
#include "raykiln/jobs/job_snapshot.hpp"
#include "raykiln/store/store.hpp"
#include "raykiln/workers/local_pool.hpp"

namespace raykiln::server {

struct LocalPicture {
  render::Image image;
  std::vector<float> error, samples;  ///< standard errors (3 a pixel), samples (1 a pixel)
  std::vector<StoredLayer> layers;    ///< those that the request asks for
  JobSnapshot job;  ///< completed, with statistics and warnings; its id is empty
};

/// Errors: those of the intake (the scene is wrong), "invalid_request" (settings, camera), and
/// "worker_failed".
[[nodiscard]] Result<LocalPicture> render_locally(
    const ScenePackage& package, const JobRequest& request, LocalPool& pool,
    const std::function<void(const ProgressState&)>& progress);

/// The picture and its noise as EXR, with what made it as attributes. Errors: "internal".
[[nodiscard]] Result<std::vector<std::uint8_t>> local_exr(const LocalPicture& picture, const std::string& scene);

}  // namespace raykiln::server
