// Which file of an upload is the scene.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "diagnostics.hpp"

namespace raykiln::render::io {

/// The only .gltf, .glb or .obj among `names`; nothing, with an error that lists the candidates,
/// when there is none or more than one.
std::optional<std::string> only_scene_file(const std::vector<std::string>& names,
                                           Diagnostics& diagnostics);

/// The format that the name's extension stands for; nothing, with the error recorded, for others.
std::optional<SceneFormat> format_of(const std::string& name, Diagnostics& diagnostics);

}  // namespace raykiln::render::io
