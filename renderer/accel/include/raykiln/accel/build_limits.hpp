// A build that keeps to a number of bytes.
#pragma once

#include <cstdint>
#include <memory>

#include "raykiln/accel/kdtree.hpp"

namespace raykiln::render {

struct BuildLimits {
  /// Most bytes that the build may hold beside the given mesh. Lowers max_duplication as far as the
  /// worst case asks for, usually several times further than was necessary. Less than least_bytes()
  /// is refused with std::length_error.
  std::uint64_t max_bytes = 0;  ///< 0: no limit
};

/// What a build with one reference a triangle may need, tree and copy of the mesh included.
[[nodiscard]] std::uint64_t least_bytes(const TriangleView& mesh, const BuildParams& params);

/// References a triangle that fit into the limits whatever the mesh is, at most params.max_duplication and at least 1.
/// A build with these limits is one without and with this for max_duplication.
[[nodiscard]] double affordable_duplication(const TriangleView& mesh, const BuildParams& params, const BuildLimits& limits);

/// As without limits, which depend on nothing but the mesh: the same tree for any TaskRunner.
[[nodiscard]] std::shared_ptr<const KdTree> build_kdtree(const TriangleView& mesh,
                                                         const BuildParams& params,
                                                         TaskRunner& runner,
                                                         const BuildLimits& limits);

}  // namespace raykiln::render
