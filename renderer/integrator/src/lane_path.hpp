// Rays and paths as the kernels for several at once read and write them. Plain data only: see vertex_query.hpp.
#pragma once

#include <cstdint>

namespace raykiln::render {

/// Ray, as it lies in memory.
struct LaneRay {
  float o[3], t_min, d[3], t_max;
};

/// PathState, as it lies in memory.
struct LanePath {
  std::uint64_t key_a, key_b, point;
  double throughput[3];
  double scale, pdf;
  std::uint64_t node;
  std::uint32_t slot;
  std::uint16_t bounce;
  bool met_diffuse;
};

/// Hit, as it lies in memory.
struct LaneHit {
  float t;
  std::uint32_t id;
  float u, v;
};

/// EmitterReceiver, as it lies in memory.
struct LaneReceiver {
  float p[3], normal[3];
  bool both_sides;
};

/// Corners of triangles.
struct LaneMesh {
  const float* positions;          ///< 3 floats each
  const std::uint32_t* triangles;  ///< three positions each
};

}  // namespace raykiln::render
