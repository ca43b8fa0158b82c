// What happens where a path meets a surface: light found, shadow rays asked for, new rays shot.
#pragma once

#include <span>
#include <stop_token>

#include "path_stream.hpp"
#include "raykiln/integrator/path_tracer.hpp"
#include "shadow_queue.hpp"

namespace raykiln::render {

/// Where the outcome of shading goes.
struct ShadingSinks {
  std::span<PathResult> results;
  ShadowQueue& shadows;
  PathStream& next;
  RenderStats& stats;
  const std::stop_token& stop;
  bool stopped = false;  ///< stop was seen: the outcome is worthless, return soon
};

/// Handles one path whose ray came back with `hit`. Light samples are queued; the queue is flushed
/// here when it is full.
void shade_vertex(const TransportScene& scene, const PathSettings& settings, const Ray& ray,
                  const PathState& state, const Hit& hit, ShadingSinks& sinks);

}  // namespace raykiln::render
