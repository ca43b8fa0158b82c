// The shading of diffuse, flat surfaces, kLanes vertices at once. VertexShader (vertex_shader.hpp) is the reference,
// one vertex at a time: same operations, same order, same bits.
#pragma once

#include "lane_casters.hpp"
#include "lane_surface.hpp"
#include "matte_query.hpp"

namespace raykiln::render {
namespace {

struct LaneVertex {
  LanePoint point;
  V3f ng;      ///< on the side of the viewer
  V3 normal;   ///< the same in double
  V3 diffuse;  ///< over pi
  V3 throughput;
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

inline V3 materials_of(const float* table, const std::uint32_t (&materials)[kLanes]) {
  alignas(64) float at[3][kLanes];
  for (int i = 0; i < kLanes; ++i) {
    for (int k = 0; k < 3; ++k) at[k][i] = table[std::size_t{3} * materials[i] + static_cast<std::size_t>(k)];
  }
  return {wide(load<F32>(at[0])), wide(load<F32>(at[1])), wide(load<F32>(at[2]))};
}

/// A batch of a query: where it reads, and the parts of paths as it needs them.
class MatteBatch {
 public:
  MatteBatch(const MatteQuery& query, MatteCounts& counts, std::size_t first)
      : query_(query), counts_(counts) {
    const std::size_t left = query.chosen_count - first;
    count_ = left < kLanes ? static_cast<int>(left) : kLanes;
    for (int i = 0; i < kLanes; ++i) index_[i] = query.chosen[first + static_cast<std::size_t>(i < count_ ? i : 0)];
  }

  void run() {
    LaneVertex vertex = read();
    for (std::size_t k = 0; k < query_.point_light_count; ++k) light_from_place(vertex, query_.point_lights[k]);
    look_for_casters(vertex);
    if (query_.emitter_sampling) light_from_emitters(vertex);
    scatter(vertex);
  }

 private:
  [[nodiscard]] const LanePath& path(int lane) const { return query_.paths[index_[lane]]; }

  LaneVertex read() {
    alignas(64) std::uint64_t words[5][kLanes];
    alignas(64) double through[3][kLanes];
    alignas(64) float barycentrics[2][kLanes], d[3][kLanes];
    std::uint32_t (&ids)[kLanes] = ids_, materials[kLanes];
    for (int i = 0; i < kLanes; ++i) {
      const LanePath& p = path(i);
      const LaneHit& hit = query_.hits[index_[i]];
      const LaneRay& ray = query_.rays[index_[i]];
      words[0][i] = p.key_a;
      words[1][i] = p.key_b;
      words[2][i] = p.point;
      words[3][i] = p.node;
      words[4][i] = p.bounce;
      for (int k = 0; k < 3; ++k) {
        through[k][i] = p.throughput[k];
        d[k][i] = ray.d[k];
      }
      barycentrics[0][i] = hit.u;
      barycentrics[1][i] = hit.v;
      ids[i] = hit.id;
      materials[i] = query_.material_ids[hit.id];
    }
    LaneVertex vertex;
    vertex.point = points_on(query_.mesh, ids, wide(load<F32>(barycentrics[0])), wide(load<F32>(barycentrics[1])));
    const V3f ng = narrow(vertex.point.ng);
    const V3 wo{wide(-load<F32>(d[0])), wide(-load<F32>(d[1])), wide(-load<F32>(d[2]))};
    const I32 front = __builtin_convertvector(dot(wide(ng), wo) >= 0.0, I32);
    vertex.ng = {front ? ng.x : -ng.x, front ? ng.y : -ng.y, front ? ng.z : -ng.z};
    vertex.normal = wide(vertex.ng);
    vertex.diffuse = all(1.0 / kLanePi) * materials_of(query_.diffuse, materials);
    vertex.throughput = {load<F64>(through[0]), load<F64>(through[1]), load<F64>(through[2])};
    vertex.key = vertex_keys(load<U64>(words[0]), load<U64>(words[1]), load<U64>(words[2]),
                             load<U64>(words[3]), load<U64>(words[4]));
    alignas(64) std::int64_t active[kLanes];
    for (int i = 0; i < kLanes; ++i) active[i] = i < count_ ? -1 : 0;
    vertex.active = load<I64>(active);
    return vertex;
  }

  void push_shadows(I64 mask, const V3f& from, const V3f& to, float t_max, const V3& light,
                    const std::uint32_t* ends) {
    const V3f d = to - from;
    for (int i = 0; i < kLanes; ++i) {
      if (mask[i] == 0) continue;
      query_.shadow_rays[counts_.shadows] = {{from.x[i], from.y[i], from.z[i]}, 0.0F,
                                             {d.x[i], d.y[i], d.z[i]}, t_max};
      query_.shadow_from[counts_.shadows] = ids_[i];
      if (ends != nullptr) query_.shadow_to[counts_.shadows] = ends[i];
      query_.shadow_lights[counts_.shadows] = {{light.x[i], light.y[i], light.z[i]}, path(i).slot};
      ++counts_.shadows;
    }
  }

  void light_from_place(const LaneVertex& vertex, const LanePointLight& light) {
    const V3 place{all(light.position[0]), all(light.position[1]), all(light.position[2])};
    const V3 way = place - vertex.point.p;
    const F64 distance2 = dot(way, way);
    const I64 apart = distance2 > 0.0;
    for (int i = 0; i < count_; ++i) counts_.lights_at_hits += apart[i] == 0;
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
    const V3 found = vertex.throughput * value.f_cos * arriving;
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
      if (i < count_) {
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
    const V3 found = weight * (vertex.throughput * value.f_cos * materials_of(query_.emission, materials));
    const I64 sent = vertex.active & (pdf_area > 0.0) & (distance2 > 0.0) & (cosine > 0.0) &
                     ~is_zero(value.f_cos) & ~is_zero(found);
    const V3f from = ray_origins(vertex.point, wi);
    push_shadows(sent, from, ray_ends(point, wide(from)), 1.0F - 0x1p-24F, found, triangles);
  }

  void look_for_casters(const LaneVertex& vertex) {
    if (query_.casters.count == 0) return;
    alignas(64) std::int64_t open[kLanes];
    for (int i = 0; i < kLanes; ++i) {
      open[i] = path(i).bounce <= query_.casters.last_bounce ? -1 : 0;
      mixes_ = mixes_ || open[i] != 0;
    }
    if (mixes_) see_casters(seen_, query_.casters, vertex.point.p, vertex.normal, load<I64>(open));
  }

  /// Of slot kLobeChoice, which at the first vertex of a path stands in another group (sobol::place_of).
  [[nodiscard]] F64 lobe_numbers(const LaneVertex& vertex) const {
    alignas(64) std::uint64_t group[kLanes];
    for (int i = 0; i < kLanes; ++i) group[i] = path(i).bounce == 0 ? 1 : 0;
    return third_of(query_.sobol, vertex.key, load<U64>(group), 4, query_.sobol_third);
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
    const F64 pdf = found_pdf(direction, value);
    I64 goes_on = vertex.active & ~is_zero(value.f_cos);
    V3 throughput = vertex.throughput * (value.f_cos / pdf);
    alignas(64) double scale[kLanes];
    for (int i = 0; i < kLanes; ++i) scale[i] = path(i).scale;
    F64 scales = load<F64>(scale);
    if (mixes_) scales *= value.pdf / pdf;
    if (query_.roulette) goes_on &= survivors(vertex, goes_on, scales, throughput);
    const V3f from = ray_origins(vertex.point, direction);
    for (int i = 0; i < count_; ++i) {
      if (goes_on[i] != 0) push_next(vertex, i, from, wi, throughput, scales[i], pdf[i]);
    }
  }

  /// survives_roulette() of each lane.
  I64 survivors(const LaneVertex& vertex, I64 candidates, F64 scales, V3& throughput) {
    alignas(64) std::int64_t plays[kLanes];
    bool any = false;
    for (int i = 0; i < kLanes; ++i) {
      plays[i] = path(i).bounce + 1U > query_.bounces_before_roulette ? -1 : 0;
      any = any || plays[i] != 0;
    }
    if (!any) return ~I64{};
    const F64 p = query_.roulette_factor * larger(larger(throughput.x, throughput.y), throughput.z) / scales;
    const I64 at_stake = load<I64>(plays) & (p < 1.0);
    const I64 ends = at_stake & (third_of(query_.sobol, vertex.key, 3, 12, query_.sobol_third) >= p);
    const I64 lost = ends & candidates;
    for (int i = 0; i < kLanes; ++i) counts_.roulette_ends += lost[i] != 0;
    throughput = select(at_stake, throughput / p, throughput);
    return ~ends;
  }

  void push_next(const LaneVertex& vertex, int i, const V3f& from, const V3f& wi, const V3& throughput, double scale,
                 double pdf) {
    const double t[3] = {throughput.x[i], throughput.y[i], throughput.z[i]};
    const LanePath& before = path(i);
    if (poisons(t, query_.emitted + before.slot * query_.emitted_stride)) return;
    const std::size_t n = counts_.next++;
    query_.next_rays[n] = {{from.x[i], from.y[i], from.z[i]}, 0.0F, {wi.x[i], wi.y[i], wi.z[i]}, __builtin_inff()};
    query_.next_from[n] = ids_[i];
    LanePath& next = query_.next_paths[n];
    next = before;
    for (int k = 0; k < 3; ++k) next.throughput[k] = t[k];
    next.scale = scale;
    next.pdf = pdf;
    next.bounce = static_cast<std::uint16_t>(before.bounce + 1);
    if (query_.next_origins == nullptr) return;
    const V3f p = narrow(vertex.point.p);
    query_.next_origins[n] = {{p.x[i], p.y[i], p.z[i]},
                              {vertex.ng.x[i], vertex.ng.y[i], vertex.ng.z[i]},
                              false};
  }

  const MatteQuery& query_;
  MatteCounts& counts_;
  int count_ = 0;
  bool mixes_ = false;  ///< directions of some lane are drawn towards casters, too
  LaneCones seen_;      ///< set where that is so
  std::uint32_t index_[kLanes], ids_[kLanes];  ///< of the paths; of the triangles that they met
};

void shade_matte_lanes(const MatteQuery& query, MatteCounts& counts) {
  for (std::size_t first = 0; first < query.chosen_count; first += kLanes) {
    MatteBatch(query, counts, first).run();
  }
}

}  // namespace
}  // namespace raykiln::render
