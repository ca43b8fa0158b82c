// Memory of what rendering derives from a scene.
#pragma once

#include <cstddef>

namespace raykiln::render {

class PreparedScene;

/// Beside the scene and its kd-tree: tables of emitters and their light tree, and smaller copies of pictures, which are
/// counted also before a render first asks for them. The table of an environment is not among them.
[[nodiscard]] std::size_t prepared_bytes(const PreparedScene& scene);

}  // namespace raykiln::render
