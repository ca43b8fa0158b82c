// Queries through a lane kernel.
#pragma once

#include <span>

#include "lane_query.hpp"
#include "raykiln/accel/kdtree_data.hpp"
#include "raykiln/accel/kernels.hpp"

namespace raykiln::render {

/// Fewer rays in a call than this walk one by one: filling lanes would cost more than it saves.
inline constexpr std::size_t kFewRays = 4;

/// The kernel of a traversal that `resolve` returned; nullptr for the scalar walk.
[[nodiscard]] LaneKernel lane_kernel(Traversal traversal, LaneMode mode, int leaf_width);

/// The same as the scalar walk, counts included. The tree is not empty.
void closest_hits_in_lanes(LaneKernel kernel, const KdTree& tree, std::span<const Ray> rays,
                           std::span<Hit> hits, std::span<const HitOrder> after,
                           const EndTriangles& ends, TriangleTest test, TraversalCounters& counters);
void any_hits_in_lanes(LaneKernel kernel, const KdTree& tree, std::span<const Ray> rays,
                       std::span<Occlusion> result, const EndTriangles& ends, TriangleTest test,
                       TraversalCounters& counters);

}  // namespace raykiln::render
