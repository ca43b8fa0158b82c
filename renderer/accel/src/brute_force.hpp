// Every ray against every triangle, straight from the mesh: what the tree must agree with.
#pragma once

#include <span>

#include "raykiln/accel/kernels.hpp"

namespace raykiln::render {

void closest_hits_brute_force(const KdTree& tree, std::span<const Ray> rays, std::span<Hit> hits,
                              std::span<const HitOrder> after, const EndTriangles& ends, TriangleTest test,
                              TraversalCounters& counters);

void any_hits_brute_force(const KdTree& tree, std::span<const Ray> rays,
                          std::span<Occlusion> result, const EndTriangles& ends, TriangleTest test,
                          TraversalCounters& counters);

}  // namespace raykiln::render
