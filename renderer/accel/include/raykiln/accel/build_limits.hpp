// A build that keeps to a number of bytes.
#pragma once

#include <cstdint>
#include <memory>

#include "raykiln/accel/kdtree.hpp"

namespace raykiln::render {

struct BuildLimits {
  /// Most bytes that the build may hold beside the given mesh. Lowers max_duplication as far as the
  /// worst case asks for, usually several times further than was necessary, but never below one
  /// reference a triangle: less memory than that cannot hold a tree.
  std::uint64_t max_bytes = 0;  ///< 0: no limit
};

/// As without limits, which depend on nothing but the mesh: the same tree for any TaskRunner.
[[nodiscard]] std::shared_ptr<const KdTree> build_kdtree(const TriangleView& mesh,
                                                         const BuildParams& params,
                                                         TaskRunner& runner,
                                                         const BuildLimits& limits);

}  // namespace raykiln::render
