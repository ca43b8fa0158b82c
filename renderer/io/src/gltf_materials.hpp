// Materials of a glTF file.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "gltf_textures.hpp"
#include "json_at.hpp"
#include "scene_draft.hpp"

namespace raykiln::render::io {

/// Ids in the draft of the file's materials, in their order; nothing after an error.
std::optional<std::vector<std::uint32_t>> read_gltf_materials(const JsonAt& root,
                                                              GltfTextures& textures,
                                                              SceneDraft& draft);

}  // namespace raykiln::render::io
