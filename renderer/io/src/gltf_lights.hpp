// Lights of KHR_lights_punctual.
#pragma once

#include <optional>

#include "json_at.hpp"
#include "scene_draft.hpp"

namespace raykiln::render::io {

/// The light `at`, placed by `node`. Nothing when it is left out with a warning, or after an error.
[[nodiscard]] std::optional<DraftLight> read_gltf_light(const JsonAt& at, const JsonAt& node,
                                                        const Mat4d& to_world);

}  // namespace raykiln::render::io
