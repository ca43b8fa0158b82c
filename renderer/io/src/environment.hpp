// The environment map that a sidecar names.
#pragma once

#include "json_at.hpp"
#include "scene_draft.hpp"

namespace raykiln::render::io {

/// The field `environment` of the sidecar, if it is there. False after an error.
[[nodiscard]] bool read_environment(const SceneFiles& files, const JsonAt& root, SceneDraft& draft);

}  // namespace raykiln::render::io
