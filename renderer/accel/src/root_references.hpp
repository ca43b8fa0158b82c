// From a mesh to the input of the root: which triangles count, their boxes, the box of all.
#pragma once

#include "subtree_builder.hpp"

namespace raykiln::render {

struct RootInput {
  SubtreeInput subtree;
  std::uint64_t dropped_degenerate = 0;
};

/// Undefined contents after a stop.
[[nodiscard]] RootInput make_root(BuildContext& context);

}  // namespace raykiln::render
