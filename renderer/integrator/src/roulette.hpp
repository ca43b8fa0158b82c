// Where a path ends by chance.
#pragma once

#include <algorithm>

#include "path_stream.hpp"
#include "transport.hpp"

namespace raykiln::render {

/// Ends a path with probability 1 - p and multiplies what goes on by 1/p, where p is three times its throughput
/// so far. The part of the throughput that is a change of medium is left out of p: inside glass of
/// index n radiance is n^2 times larger, on the way from the camera throughput n^2 times smaller,
/// and such a path is worth no less. What goes on has a throughput of at least
/// a third of `scale`, so weights stay bounded.
inline bool survives_roulette(PathState& path, const VertexKey& key) {
  if (path.bounce <= static_cast<std::uint32_t>(kFirstDrawAfter)) return true;
  const Rgbd& t = path.throughput;
  const double p = kRouletteFactor * std::max({t.x, t.y, t.z}) / path.scale;
  if (!(p < 1.0)) return true;  // also what is not finite: it is counted further on
  if (uniform(key, Dimension::kRoulette) >= p) return false;
  path.throughput /= p;
  return true;
}

}  // namespace raykiln::render
