// A scene's tree that keeps to a number of bytes.
#pragma once

#include <cstdint>
#include <memory>

#include "raykiln/accel/build_limits.hpp"
#include "raykiln/render/render.hpp"

namespace raykiln::render {

/// As build_scene_tree() of render.hpp. Precondition: limits.max_bytes is 0 or at least least_tree_bytes().
[[nodiscard]] std::shared_ptr<const KdTree> build_scene_tree(const Scene& scene,
                                                             const BuildParams& params,
                                                             TaskRunner& runner,
                                                             const BuildLimits& limits);

/// Bytes that the build of the scene's tree may need with one reference a triangle.
[[nodiscard]] std::uint64_t least_tree_bytes(const Scene& scene, const BuildParams& params);

/// References a triangle that the limits leave of params.max_duplication: all that they decide of the tree.
[[nodiscard]] double affordable_references(const Scene& scene, const BuildParams& params, const BuildLimits& limits);

}  // namespace raykiln::render
