// What every kernel for several vertices at once reads and writes, whatever they lie on. Plain data and pointers only,
// as in renderer/accel: an inline function here would be compiled once with AVX and once without, and the linker would
// keep either.
#pragma once

#include <cstddef>
#include <cstdint>

#include "lane_path.hpp"

namespace raykiln::render {

/// Vertices of one kind, and the paths that go on from them: at most one from each.
struct VertexQuery {
  LaneMesh mesh;
  const std::uint32_t* material_ids;

  bool emitter_sampling, roulette;
  std::uint32_t bounces_before_roulette;
  double roulette_factor;

  const LaneRay* rays;
  const LaneHit* hits;
  const LanePath* paths;
  const std::uint32_t* chosen;  ///< which of them are vertices of this kind
  std::size_t chosen_count;

  LaneRay* next_rays;  ///< room for one a vertex, and so for what goes with it
  LanePath* next_paths;
  std::uint32_t* next_from;    ///< the triangles that they leave
  LaneReceiver* next_origins;  ///< null where emitters are not drawn from a tree
  double* emitted;             ///< of slot 0; poisoned by throughputs that are not finite
  std::size_t emitted_stride;
};

struct VertexCounts {
  std::size_t next;
  std::uint64_t roulette_ends;
};

}  // namespace raykiln::render
