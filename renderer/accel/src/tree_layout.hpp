// Gives the nodes of all subtrees their final places: the pass that makes the bytes of a tree
// independent of how its build was cut into tasks.
#pragma once

#include "build_context.hpp"
#include "raykiln/accel/kdtree_data.hpp"
#include "subtree_builder.hpp"

namespace raykiln::render {

/// Fills nodes, blocks and the statistics of `tree`, whose box and params are set; frees the linked
/// subtrees as it goes. False when it was stopped.
[[nodiscard]] bool lay_out(BuildContext& context, Subtree& root, KdTree& tree);

}  // namespace raykiln::render
