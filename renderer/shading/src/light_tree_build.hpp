// Building a light tree, from the root down.
#pragma once

#include <span>
#include <vector>

#include "raykiln/shading/light_tree.hpp"

namespace raykiln::render::light_tree {

struct Built {
  std::vector<LightTree::Node> nodes;
  std::vector<std::uint64_t> ways;
};

/// Precondition: not empty.
[[nodiscard]] Built build(std::span<const EmitterBounds> emitters);

}  // namespace raykiln::render::light_tree
