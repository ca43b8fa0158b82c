// What happens where paths meet surfaces: light found, shadow rays asked for, new rays shot.
#pragma once

#include <span>
#include <stop_token>

#include "path_stream.hpp"
#include "shadow_queue.hpp"
#include "raykiln/shading/caster_cones.hpp"
#include "transport.hpp"

namespace raykiln::render {

/// Where the outcome of shading goes.
struct ShadingSinks {
  std::span<PathResult> results;
  ShadowQueue& shadows;
  PathStream& next;
  RenderStats& stats;
  const std::stop_token& stop;
  Material painted{};  ///< scratch: a material with its textures at one point
  CasterCones seen{};  ///< scratch: bodies as one surface point sees them
  bool stopped = false;  ///< stop was seen: the outcome is worthless, return soon
};

class MatteGroup;
class AxisGroup;

/// Paths `begin` .. `end` of `front`, whose rays came back with `hits`. Light samples are queued;
/// the queue is flushed on the way when it is full.
struct ShadingRange {
  const PathStream& front;
  std::span<const Hit> hits;
  std::size_t begin = 0, end = 0;
  MatteGroup& mattes;  ///< shades those of its kind, and so does
  AxisGroup& axes;
};
/// An instance of the loop.
struct ShadingLoop {
  const char* name;
  void (*run)(const Transport&, const ShadingRange&, ShadingSinks&);
};

/// The instance that is made for these switches. Chosen once a tile.
[[nodiscard]] ShadingLoop shading_loop(const Switches& switches);

// The instances, each compiled by itself.
void shade_general(const Transport& transport, const ShadingRange& range, ShadingSinks& sinks);
void shade_reduced(const Transport& transport, const ShadingRange& range, ShadingSinks& sinks);
void shade_phong(const Transport& transport, const ShadingRange& range, ShadingSinks& sinks);
void shade_opaque(const Transport& transport, const ShadingRange& range, ShadingSinks& sinks);
void shade_matte(const Transport& transport, const ShadingRange& range, ShadingSinks& sinks);
void shade_flat_matte(const Transport& transport, const ShadingRange& range, ShadingSinks& sinks);
void shade_direct_flat_matte(const Transport& transport, const ShadingRange& range,
                             ShadingSinks& sinks);

}  // namespace raykiln::render
