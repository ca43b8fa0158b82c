// A texture statement of an MTL file: options and a file name.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "raykiln/scene/surface_textures.hpp"

namespace raykiln::render::io {

struct MtlMap {
  std::string file;
  TextureUse use;                    ///< without its picture; v counts downwards, as in a scene
  std::vector<std::string> ignored;  ///< options that are not followed
};

/// The words behind map_Kd: -s, -o and -clamp are followed, other known options passed over. The
/// name is all that is left, spaces too.
[[nodiscard]] MtlMap read_mtl_map(std::string_view text);

}  // namespace raykiln::render::io
