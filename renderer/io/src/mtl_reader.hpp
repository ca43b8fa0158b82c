// Wavefront MTL -> materials of the draft. The mapping is in the module's README.
#pragma once

#include <string>

#include "diagnostics.hpp"
#include "scene_draft.hpp"

namespace raykiln::render::io {

/// False when diagnostics has the error. A material defined twice keeps its first definition.
bool read_mtl(const SceneFiles& files, const std::string& name, Diagnostics& diagnostics,
              SceneDraft& draft);

}  // namespace raykiln::render::io
