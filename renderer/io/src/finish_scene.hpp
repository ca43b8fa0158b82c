// Draft -> scene: units, re-centring, rounding to float, dropping what has no area, defaults.
#pragma once

#include "diagnostics.hpp"
#include "scene_draft.hpp"

namespace raykiln::render::io {

/// Consumes the draft. False when diagnostics has the error. Fills the counts of the report.
bool finish_scene(SceneDraft&& draft, Diagnostics& diagnostics, Scene& scene,
                  ImportReport& report);

}  // namespace raykiln::render::io
