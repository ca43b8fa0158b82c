// Counts of light transport.
#pragma once

#include <cstdint>

#include "raykiln/accel/kdtree.hpp"

namespace raykiln::render {

/// Counts of one task. Rays, paths and samples add up to the same however the work was cut; calls,
/// steps of the walk and seconds need not, and what was done several at once goes by the kernel.
struct RenderStats {
  std::uint64_t camera_rays = 0, bounce_rays = 0, shadow_rays = 0;
  std::uint64_t paths = 0, non_finite = 0, negative = 0, truncated = 0;
  std::uint64_t roulette_ends = 0;   ///< paths that roulette ended
  std::uint64_t gap_rays = 0;        ///< rays that went on through a gap in a surface, each time
  std::uint64_t lights_at_hits = 0;  ///< point lights at distance 0 from what they should light: add 0
  std::uint64_t closest_calls = 0;            ///< calls of closest_hits
  std::uint64_t short_calls_while_many_live = 0;  ///< fewer than 1024 rays although as many paths lived
  /// Shot or shaded several at once: camera rays, diffuse vertices, those on mirrors and clear borders.
  std::uint64_t lane_camera_rays = 0, lane_mattes = 0, lane_axes = 0;
  double traversal_seconds = 0.0;  ///< in closest_hits and any_hits
  double shading_seconds = 0.0;    ///< between them
  TraversalCounters traversal;
};

/// Adds every count of `other`.
void add(RenderStats& stats, const RenderStats& other);

}  // namespace raykiln::render
