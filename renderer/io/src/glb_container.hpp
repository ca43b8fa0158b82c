// The GLB container: a JSON chunk and at most one binary chunk.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "diagnostics.hpp"

namespace raykiln::render::io {

struct GlbChunks {
  std::string_view json;
  std::optional<std::string_view> binary;
};

/// Views into `bytes`; nothing, with the error recorded, when the container is damaged. Chunks of
/// other types are skipped, as glTF 2.0 section 4.4.3 asks.
std::optional<GlbChunks> split_glb(std::string_view bytes, const std::string& name,
                                   Diagnostics& diagnostics);

}  // namespace raykiln::render::io
