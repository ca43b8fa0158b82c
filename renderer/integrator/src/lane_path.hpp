// Rays and paths as the kernels for several at once read and write them. Plain data only: see matte_query.hpp.
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

}  // namespace raykiln::render
