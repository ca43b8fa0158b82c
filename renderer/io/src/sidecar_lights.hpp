// The lights that a sidecar adds.
#pragma once

#include "json_at.hpp"
#include "scene_draft.hpp"

namespace raykiln::render::io {

/// `key`, which must be there: a position within the limits.
[[nodiscard]] Vec3d required_point(const JsonAt& at, const char* key);

/// point_lights, spot_lights and directional_lights. False after an error.
[[nodiscard]] bool read_sidecar_lights(const JsonAt& root, SceneDraft& draft);

}  // namespace raykiln::render::io
