// The shading of diffuse, flat surfaces, kLanes vertices at once. VertexShader (vertex_shader.hpp) is the reference,
// one vertex at a time: same operations, same order, same bits.
#pragma once

#include "lane_casters.hpp"
#include "lane_vertices.hpp"
#include "matte_query.hpp"

namespace raykiln::render {
namespace {

struct LaneVertex {
  LanePoint point;
  V3f ng;      ///< on the side of the viewer
  V3 normal;   ///< the same in double
  V3 diffuse;  ///< over pi
  LanePaths path;
  Keys key;
  I64 active;  ///< lanes with a vertex
};

/// f cos and density of directions rounded to float; black from behind.
struct LaneValue {
  V3 f_cos;
  F64 pdf;
};
inline LaneValue evaluate(const LaneVertex& vertex, const V3& wi) {
  const F64 side = dot(vertex.normal, wi);
  const I64 above = side > 0.0;
  const F64 cosine = larger(smaller(side, all(1.0)), F64{});
  const F64 cos_i = select(above, cosine, F64{});
  return {cos_i * vertex.diffuse, cos_i / kLanePi};
}

constexpr std::uint32_t kNoTriangle = 0xFFFFFFFFU;

inline V3 materials_of(const float* table, const std::uint32_t (&materials)[kLanes]) {
  return wide(read_threes([&](int i) { return table + std::size_t{3} * materials[i]; }));
}

/// A batch of a query: where it reads, and the parts of paths as it needs them.
class MatteBatch {
 public:
  MatteBatch(const MatteQuery& query, MatteCounts& counts, std::size_t first)
      : query_(query), counts_(counts), chosen_(choose(query, first)) {}

  void run() {
    LaneVertex vertex = read();
    for (std::size_t k = 0; k < query_.point_light_count; ++k) light_from_place(vertex, query_.point_lights[k]);
    look_for_casters(vertex);
    if (query_.emitter_sampling) light_from_emitters(vertex);
    scatter(vertex);
  }

 private:
  LaneVertex read() {
    const LaneHits hits = read_hits(query_, chosen_, ids_);
    std::uint32_t materials[kLanes];
    for (int i = 0; i < kLanes; ++i) materials[i] = query_.material_ids[ids_[i]];
    LaneVertex vertex;
    vertex.point = points_on(query_.mesh, ids_, hits.u, hits.v);
    const V3f ng = narrow(vertex.point.ng);
    const I32 front = __builtin_convertvector(dot(wide(ng), hits.wo) >= 0.0, I32);
    vertex.ng = {front ? ng.x : -ng.x, front ? ng.y : -ng.y, front ? ng.z : -ng.z};
    vertex.normal = wide(vertex.ng);
    vertex.diffuse = all(1.0 / kLanePi) * materials_of(query_.diffuse, materials);
    vertex.path = read_paths(query_, chosen_);
    vertex.key = vertex_keys(vertex.path.key_a, vertex.path.key_b, vertex.path.point, vertex.path.node,
                             vertex.path.bounce);
    vertex.active = active_lanes(chosen_);
    return vertex;
  }

  /// As push_paths() does. `ends`: triangles on which they end, or null.
  void push_shadows(I64 mask, const V3f& from, const V3f& to, float t_max, const V3& light,
                    const std::uint32_t* ends) {
    const std::uint32_t bits = bits_of(mask);
    const RayRows rays = ray_rows(from, to - from, t_max);
    U64 slots;
    for (int i = 0; i < kLanes; ++i) slots[i] = query_.paths[chosen_.index[i]].slot;
    const auto lights = turned(Fours<U64>{{as<U64>(light.x), as<U64>(light.y), as<U64>(light.z), slots}});
    std::size_t n = counts_.shadows;
#pragma GCC unroll 8
    for (int i = 0; i < kLanes; ++i) {
      if (i == chosen_.count) break;
      write(rays, i, query_.shadow_rays[n]);
      store(reinterpret_cast<std::uint64_t*>(&query_.shadow_lights[n]), row_of(lights, i));
      query_.shadow_from[n] = ids_[i];
      query_.shadow_to[n] = ends == nullptr ? kNoTriangle : ends[i];
      n += bits >> i & 1U;
    }
    counts_.shadows = n;
  }

  void light_from_place(const LaneVertex& vertex, const LanePointLight& light) {
    const V3 place{all(light.position[0]), all(light.position[1]), all(light.position[2])};
    const V3 way = place - vertex.point.p;
    const F64 distance2 = dot(way, way);
    const I64 apart = distance2 > 0.0;
    for (int i = 0; i < chosen_.count; ++i) counts_.lights_at_hits += apart[i] == 0;
    const V3 over = place - vertex.point.corner;
    const F64 height = dot(vertex.point.ng, over);
    const I64 level = absolute(height) <= 0x1p-50 * dot(absolute(vertex.point.ng), absolute(over));
    const I64 from_front = dot(vertex.normal, vertex.point.ng) > 0.0;
    const I64 lit = ~level & (height != 0.0) & ~((height > 0.0) ^ from_front);
    const V3 wi = way / root(distance2);
    V3 arriving{light.intensity[0] / distance2, light.intensity[1] / distance2, light.intensity[2] / distance2};
    if (light.range2 > 0.0) {
      const F64 ratio2 = distance2 / light.range2;
      arriving = larger(1.0 - ratio2 * ratio2, F64{}) * arriving;
    }
    const LaneValue value = evaluate(vertex, wide(narrow(wi)));
    const V3 found = vertex.path.throughput * value.f_cos * arriving;
    const V3f to = narrow(place);
    push_shadows(vertex.active & apart & lit & ~is_zero(arriving) & ~is_zero(found),
                 ray_origins(vertex.point, wi), to, 1.0F - 16.0F * 0x1p-24F, found, nullptr);
  }

  /// Weighted by power: the first index whose sum exceeds u times the total.
  [[nodiscard]] std::uint32_t draw_by_power(double u) const {
    const double total = query_.cumulative[query_.emitter_count - 1];
    const double wanted = u * total;
    std::size_t low = 0, length = query_.emitter_count;
    while (length > 0) {
      const std::size_t half = length / 2;
      if (wanted < query_.cumulative[low + half]) {
        length = half;
      } else {
        low += half + 1;
        length -= half + 1;
      }
    }
    if (low < query_.emitter_count) return static_cast<std::uint32_t>(low);
    low = 0;
    while (query_.cumulative[low] < total) ++low;
    return static_cast<std::uint32_t>(low);
  }

  /// The same for each lane. Sums rise, so where there are few of them those at or below u times the total are counted.
  void draw_by_power(F64 u, std::uint32_t (&drawn)[kLanes]) const {
    constexpr std::size_t kFew = 16;
    alignas(64) std::int64_t below[kLanes];
    I64 counted{};
    const bool few = query_.emitter_count <= kFew;
    if (few) {
      const F64 wanted = u * query_.cumulative[query_.emitter_count - 1];
      for (std::size_t k = 0; k < query_.emitter_count; ++k) counted -= ~(wanted < query_.cumulative[k]);
    }
    store(below, counted);
    for (int i = 0; i < kLanes; ++i) {
      const auto place = static_cast<std::size_t>(below[i]);
      drawn[i] = few && place < query_.emitter_count ? static_cast<std::uint32_t>(place) : draw_by_power(u[i]);
    }
  }

  /// Triangles drawn for each lane, with the density of each per area; 0 where nothing can be drawn.
  F64 draw(const LaneVertex& vertex, F64 u, std::uint32_t (&triangles)[kLanes]) const {
    alignas(64) double pdf_area[kLanes];
    if (query_.tree == nullptr) {
      std::uint32_t drawn[kLanes];
      draw_by_power(u, drawn);
      for (int i = 0; i < kLanes; ++i) {
        triangles[i] = query_.emitters[drawn[i]];
        pdf_area[i] = query_.pdf_area[query_.material_ids[triangles[i]]];
      }
      return load<F64>(pdf_area);
    }
    const V3f p = narrow(vertex.point.p);
    for (int i = 0; i < kLanes; ++i) {
      LaneDraw drawn{0, 0.0};
      if (i < chosen_.count) {
        const LaneReceiver receiver{{p.x[i], p.y[i], p.z[i]},
                                    {vertex.ng.x[i], vertex.ng.y[i], vertex.ng.z[i]},
                                    false};
        drawn = query_.draw(query_.tree, receiver, u[i]);
      }
      pdf_area[i] = drawn.pdf_area;
      triangles[i] = drawn.pdf_area > 0.0 ? drawn.triangle : query_.emitters[0];
    }
    return load<F64>(pdf_area);
  }

  void light_from_emitters(const LaneVertex& vertex) {
    const F64 choice = third_of(query_.sobol, vertex.key, 2, 9, query_.sobol_third);
    std::uint32_t triangles[kLanes], materials[kLanes];
    const F64 pdf_area = draw(vertex, choice, triangles);
    for (int i = 0; i < kLanes; ++i) materials[i] = query_.material_ids[triangles[i]];
    const Pair at = first_pair(query_.sobol, vertex.key, 2, 10);
    const F64 sheared = root(at.u);
    const LanePoint point = points_on(query_.mesh, triangles, sheared * (1.0 - at.v), sheared * at.v);

    const V3 way = point.p - vertex.point.p;
    const F64 distance2 = dot(way, way);
    const V3 wi = way / root(distance2);
    const F64 cosine = absolute(dot(point.ng, wi));
    const F64 pdf = pdf_area * distance2 / cosine;
    const V3 rounded = wide(narrow(wi));
    const LaneValue value = evaluate(vertex, rounded);
    const F64 ratio = found_pdf(rounded, value) / pdf;
    const F64 weight = 1.0 / (1.0 + ratio * ratio) / pdf;
    const V3 found = weight * (vertex.path.throughput * value.f_cos * materials_of(query_.emission, materials));
    const I64 sent = vertex.active & (pdf_area > 0.0) & (distance2 > 0.0) & (cosine > 0.0) &
                     ~is_zero(value.f_cos) & ~is_zero(found);
    const V3f from = ray_origins(vertex.point, wi);
    push_shadows(sent, from, ray_ends(point, wide(from)), 1.0F - 0x1p-24F, found, triangles);
  }

  void look_for_casters(const LaneVertex& vertex) {
    if (query_.casters.count == 0) return;
    const I64 open = as<I64>(vertex.path.bounce) <= static_cast<std::int64_t>(query_.casters.last_bounce);
    mixes_ = bits_of(open) != 0;
    if (mixes_) see_casters(seen_, query_.casters, vertex.point.p, vertex.normal, open);
  }

  /// Of slot kLobeChoice, which at the first vertex of a path stands in another group (sobol::place_of).
  [[nodiscard]] F64 lobe_numbers(const LaneVertex& vertex) const {
    const U64 group = as<U64>(vertex.path.bounce == 0) & 1U;
    return third_of(query_.sobol, vertex.key, group, 4, query_.sobol_third);
  }

  /// The density with which scatter() finds directions of these values.
  [[nodiscard]] F64 found_pdf(const V3& wi, const LaneValue& value) const {
    return mixes_ ? mixed_pdf(seen_, wi, value.pdf) : value.pdf;
  }

  void scatter(const LaneVertex& vertex) {
    const Pair at = first_pair(query_.sobol, vertex.key, 0, 6);
    F64 x = at.u / (1.0 + root(1.0 - at.u));
    V3f axis = vertex.ng;
    if (mixes_) choose_cone(seen_, lobe_numbers(vertex), at.u, axis, x);
    const V3f wi = around_axes(axis, x, at.v);
    const V3 direction = wide(wi);
    const LaneValue value = evaluate(vertex, direction);
    LaneNext next;
    next.pdf = found_pdf(direction, value);
    next.goes_on = vertex.active & ~is_zero(value.f_cos);
    next.throughput = vertex.path.throughput * (value.f_cos / next.pdf);
    next.scale = mixes_ ? vertex.path.scale * (value.pdf / next.pdf) : vertex.path.scale;
    if (query_.roulette) play(vertex, next);
    next.from = ray_origins(vertex.point, direction);
    next.wi = wi;
    next.p = narrow(vertex.point.p);
    next.normal = vertex.ng;
    next.both_sides = I64{};
    push_paths(query_, counts_, chosen_, vertex.path, ids_, next);
  }

  /// survives_roulette() of each lane.
  void play(const LaneVertex& vertex, LaneNext& next) {
    const I64 plays = as<I64>(vertex.path.bounce) >= static_cast<std::int64_t>(query_.bounces_before_roulette);
    if (bits_of(plays) == 0) return;
    const F64 p = query_.roulette_factor * largest(next.throughput) / next.scale;
    const I64 at_stake = plays & (p < 1.0);
    const I64 ends = at_stake & (third_of(query_.sobol, vertex.key, 3, 12, query_.sobol_third) >= p);
    counts_.roulette_ends += static_cast<std::uint32_t>(__builtin_popcount(bits_of(ends & next.goes_on)));
    next.throughput = select(at_stake, next.throughput / p, next.throughput);
    next.goes_on &= ~ends;
  }

  const MatteQuery& query_;
  MatteCounts& counts_;
  LaneChoice chosen_;
  bool mixes_ = false;  ///< directions of some lane are drawn towards casters, too
  LaneCones seen_;      ///< set where that is so
  std::uint32_t ids_[kLanes];  ///< of the triangles that the paths met
};

void shade_matte_lanes(const MatteQuery& query, MatteCounts& counts) {
  for (std::size_t first = 0; first < query.chosen_count; first += kLanes) {
    MatteBatch(query, counts, first).run();
  }
}

}  // namespace
}  // namespace raykiln::render
