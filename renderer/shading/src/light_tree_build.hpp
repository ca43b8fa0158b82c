// Building a light tree, from the root down.
#pragma once

#include <span>
#include <stop_token>
#include <vector>

#include "raykiln/shading/light_tree.hpp"

namespace raykiln::render::light_tree {

struct Built {
  std::vector<LightTree::Node> nodes;
  std::vector<std::uint64_t> ways;
};

/// Of nothing where stop was requested before it was whole. Precondition: not empty.
[[nodiscard]] Built build(std::span<const EmitterBounds> emitters, const std::stop_token& stop);

}  // namespace raykiln::render::light_tree
