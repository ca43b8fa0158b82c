// Paths and hits of kLanes vertices as vectors, and the paths that go on from them back in rows.
#pragma once

#include <cstddef>
#include <cstdint>

#include "lane_rows.hpp"
#include "lane_surface.hpp"
#include "vertex_query.hpp"

namespace raykiln::render {
namespace {

/// Which vertices of a query a batch holds. Lanes behind the last one repeat the first, and are not active.
struct LaneChoice {
  int count;
  std::uint32_t index[kLanes];  ///< of the paths
};
inline LaneChoice choose(const VertexQuery& query, std::size_t first) {
  LaneChoice chosen;
  const std::size_t left = query.chosen_count - first;
  chosen.count = left < kLanes ? static_cast<int>(left) : kLanes;
  for (int i = 0; i < kLanes; ++i) {
    chosen.index[i] = query.chosen[first + static_cast<std::size_t>(i < chosen.count ? i : 0)];
  }
  return chosen;
}
inline I64 active_lanes(const LaneChoice& chosen) {
  I64 lane{};
  for (int i = 0; i < kLanes; ++i) lane[i] = i;
  return lane < chosen.count;
}

struct LanePaths {
  U64 key_a, key_b, point, node, bounce;
  V3 throughput;
  F64 scale;
};
static_assert(sizeof(LanePath) == 80 && offsetof(LanePath, throughput) == 24 && offsetof(LanePath, pdf) == 56 &&
              offsetof(LanePath, bounce) == 76);

inline LanePaths read_paths(const VertexQuery& query, const LaneChoice& chosen) {
  const auto row = [&](int i) { return &query.paths[chosen.index[i]]; };
  const auto words = [&](int i) { return reinterpret_cast<const std::uint64_t*>(row(i)); };
  const Fours<U64> low = read_fours<U64>(words);
  const Fours<U64> high = read_fours<U64>([&](int i) { return words(i) + 4; });
  LanePaths paths;
  paths.key_a = low.v[0];
  paths.key_b = low.v[1];
  paths.point = low.v[2];
  paths.throughput = {as<F64>(low.v[3]), as<F64>(high.v[0]), as<F64>(high.v[1])};
  paths.scale = as<F64>(high.v[2]);
  for (int i = 0; i < kLanes; ++i) {
    paths.node[i] = row(i)->node;
    paths.bounce[i] = row(i)->bounce;
  }
  return paths;
}

struct LaneHits {
  F64 u, v;
  V3 wo;  ///< towards where the ray came from, not normalised
};
/// Writes the triangles to `ids`.
inline LaneHits read_hits(const VertexQuery& query, const LaneChoice& chosen, std::uint32_t (&ids)[kLanes]) {
  const Fours<F32> hits = read_fours<F32>([&](int i) { return reinterpret_cast<const float*>(&query.hits[chosen.index[i]]); });
  const Fours<F32> d = read_fours<F32>([&](int i) { return reinterpret_cast<const float*>(&query.rays[chosen.index[i]]) + 4; });
  store(ids, hits.v[1]);
  return {wide(hits.v[2]), wide(hits.v[3]), {wide(-d.v[0]), wide(-d.v[1]), wide(-d.v[2])}};
}

/// Rays in rows: origin and 0, direction and end.
struct RayRows {
  Fours<F32> from, towards;
};
inline RayRows ray_rows(const V3f& o, const V3f& d, float t_max) {
  return {turned(Fours<F32>{{o.x, o.y, o.z, F32{}}}), turned(Fours<F32>{{d.x, d.y, d.z, F32{} + t_max}})};
}
inline void write(const RayRows& rows, int lane, LaneRay& to) {
  store(reinterpret_cast<float*>(&to), row_of(rows.from, lane));
  store(reinterpret_cast<float*>(&to) + 4, row_of(rows.towards, lane));
}

/// What goes on from a batch.
struct LaneNext {
  I64 goes_on;  ///< in which lanes
  V3f from, wi;
  V3 throughput;
  F64 scale, pdf;
  V3f p, normal;   ///< where the paths come from,
  I64 both_sides;  ///< asked for only where emitters are drawn from a tree
};

/// Paths with a throughput that is not finite end: it is added to what their sample found, which is then dropped and
/// counted.
inline void poison(const VertexQuery& query, const LaneChoice& chosen, LaneNext& next) {
  const V3 zero = next.throughput - next.throughput;
  const I64 finite = is_zero(zero);
  const std::uint32_t bad = bits_of(next.goes_on & ~finite);
  next.goes_on &= finite;
  if (bad == 0) return;
  for (int i = 0; i < kLanes; ++i) {
    if ((bad >> i & 1U) == 0) continue;
    double* const emitted = query.emitted + query.paths[chosen.index[i]].slot * query.emitted_stride;
    emitted[0] += next.throughput.x[i];
    emitted[1] += next.throughput.y[i];
    emitted[2] += next.throughput.z[i];
  }
}

/// Appends the paths that go on. Every lane is written where the next one that does belongs, so there is no branch.
inline void push_paths(const VertexQuery& query, VertexCounts& counts, const LaneChoice& chosen, const LanePaths& before,
                       const std::uint32_t (&ids)[kLanes], LaneNext& next) {
  poison(query, chosen, next);
  const std::uint32_t bits = bits_of(next.goes_on);
  const RayRows rays = ray_rows(next.from, next.wi, __builtin_inff());
  const auto low = turned(Fours<U64>{{before.key_a, before.key_b, before.point, as<U64>(next.throughput.x)}});
  const auto high = turned(Fours<U64>{
      {as<U64>(next.throughput.y), as<U64>(next.throughput.z), as<U64>(next.scale), as<U64>(next.pdf)}});
  std::size_t n = counts.next;
#pragma GCC unroll 8
  for (int i = 0; i < kLanes; ++i) {
    if (i == chosen.count) break;
    write(rays, i, query.next_rays[n]);
    query.next_from[n] = ids[i];
    const LanePath& path = query.paths[chosen.index[i]];
    LanePath& to = query.next_paths[n];
    store(reinterpret_cast<std::uint64_t*>(&to), row_of(low, i));
    store(reinterpret_cast<std::uint64_t*>(&to) + 4, row_of(high, i));
    to.node = path.node;
    to.slot = path.slot;
    to.bounce = static_cast<std::uint16_t>(path.bounce + 1);
    to.met_diffuse = path.met_diffuse;
    if (query.next_origins != nullptr) {
      query.next_origins[n] = {{next.p.x[i], next.p.y[i], next.p.z[i]},
                               {next.normal.x[i], next.normal.y[i], next.normal.z[i]},
                               next.both_sides[i] != 0};
    }
    n += bits >> i & 1U;
  }
  counts.next = n;
}

}  // namespace
}  // namespace raykiln::render
