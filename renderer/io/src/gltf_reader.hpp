// glTF 2.0 and GLB -> draft.
#pragma once

#include <string>

#include "diagnostics.hpp"
#include "scene_draft.hpp"

namespace raykiln::render::io {

/// Reads `name` with the buffers that it names. False when diagnostics has the error.
bool read_gltf(const SceneFiles& files, const std::string& name, Diagnostics& diagnostics,
               SceneDraft& draft);
bool read_glb(const SceneFiles& files, const std::string& name, Diagnostics& diagnostics,
              SceneDraft& draft);

}  // namespace raykiln::render::io
