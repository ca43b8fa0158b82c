// What the importer says, in the words of the API.
#pragma once

#include "raykiln/base/result.hpp"
#include "raykiln/io/import.hpp"
#include "raykiln/workers/scene_report.hpp"

namespace raykiln::server {

[[nodiscard]] Error to_error(const render::ImportError& error);
[[nodiscard]] SceneReport to_report(const render::Scene& scene, const render::ImportReport& report);

}  // namespace raykiln::server
