// raykiln.json: what the scene file cannot say. Schema: proto/scene.schema.json.
#pragma once

#include <optional>
#include <string>

#include "json_at.hpp"
#include "scene_draft.hpp"

namespace raykiln::render::io {

/// The parsed sidecar `name`; nothing, with the error recorded, when it cannot be read.
std::optional<JsonDocument> read_sidecar(const SceneFiles& files, const std::string& name,
                                         Diagnostics& diagnostics);

/// Adds its cameras (before those of the file), lights, background or environment, and overrides
/// materials.
bool apply_sidecar(const SceneFiles& files, const JsonAt& root, SceneDraft& draft);

}  // namespace raykiln::render::io
