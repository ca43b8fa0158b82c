// Wavefront OBJ -> draft.
#pragma once

#include <string>

#include "diagnostics.hpp"
#include "scene_draft.hpp"

namespace raykiln::render::io {

/// Reads `name` and the material libraries that it names. False when diagnostics has the error.
bool read_obj(const SceneFiles& files, const std::string& name, Diagnostics& diagnostics,
              SceneDraft& draft);

}  // namespace raykiln::render::io
