// The shading of mirrors and clear borders, kLanes vertices at once. VertexShader (vertex_shader.hpp) with Bsdf
// (shading/src/bsdf.cpp, fresnel.cpp) is the reference, one vertex at a time: same operations, same order, same bits.
#pragma once

#include "axis_query.hpp"
#include "lane_vertices.hpp"

namespace raykiln::render {
namespace {

inline V3 normalized(const V3& v) {
  const F64 inverse = 1.0 / root(dot(v, v));
  return inverse * v;
}
inline V3f select(I64 m, const V3f& a, const V3f& b) {
  const I32 narrow_m = __builtin_convertvector(m, I32);
  return {narrow_m ? a.x : b.x, narrow_m ? a.y : b.y, narrow_m ? a.z : b.z};
}
inline I64 select(I64 m, I64 a, I64 b) { return (m & a) | (~m & b); }
inline V3f operator-(const V3f& a) { return {-a.x, -a.y, -a.z}; }
inline V3f zero_vector() { return {F32{}, F32{}, F32{}}; }
inline bool any(I64 m) { return bits_of(m) != 0; }

struct LaneFresnel {
  F64 reflectance, cos_t;
  I64 total;
};
/// fresnel_exact().
inline LaneFresnel fresnel_of(F64 cos_from, F64 eta_from, F64 eta_to) {
  const F64 ratio = eta_from / eta_to;
  const F64 sin2_from = larger((1.0 - cos_from) * (1.0 + cos_from), F64{});
  const F64 sin2_to = ratio * ratio * sin2_from;
  const I64 equal = eta_from == eta_to;
  const I64 total = ~(sin2_to < 1.0) & ~equal;
  const F64 cos_t = select(equal, cos_from, select(total, F64{}, root(1.0 - sin2_to)));
  const F64 s_from = eta_from * cos_from, s_to = eta_to * cos_t;
  const F64 p_from = eta_to * cos_from, p_to = eta_from * cos_t;
  const F64 rs = (s_from - s_to) / (s_from + s_to);
  const F64 rp = (p_from - p_to) / (p_from + p_to);
  const F64 part = 0.5 * (rs * rs + rp * rp);
  return {select(equal, F64{}, select(total, all(1.0), part)), cos_t, total};
}

class AxisBatch {
 public:
  AxisBatch(const AxisQuery& query, AxisCounts& counts, std::size_t first)
      : query_(query), counts_(counts), chosen_(choose(query, first)) {}

  void run() {
    read();
    look_across();
    const I64 found = light_may_come();
    if (const std::uint32_t bits = bits_of(found); bits != 0) {
      for (int i = 0; i < kLanes; ++i) {
        if ((bits >> i & 1U) != 0) query_.left[counts_.left++] = chosen_.index[i];
      }
    }
    active_ &= ~found;
    LaneNext next = scatter();
    if (query_.roulette) play(next);
    next.from = ray_origins(point_, wide(next.wi));
    next.p = narrow(point_.p);
    next.normal = ng_;
    next.both_sides = transparent_ > 0.0;
    push_paths(query_, counts_, chosen_, path_, ids_, next);
  }

 private:
  [[nodiscard]] const LanePath& path(int lane) const { return query_.paths[chosen_.index[lane]]; }

  void read() {
    const LaneHits hits = read_hits(query_, chosen_, ids_);
    const auto row = [&](int i) {
      return reinterpret_cast<const std::uint64_t*>(&query_.materials[query_.material_ids[ids_[i]]]);
    };
    const Fours<U64> low = read_fours<U64>(row), high = read_fours<U64>([&](int i) { return row(i) + 4; });
    point_ = points_on(query_.mesh, ids_, hits.u, hits.v);
    ng_ = narrow(point_.ng);
    n_ = shading_normals(ids_, hits.u, hits.v);
    wo_ = hits.wo;
    path_ = read_paths(query_, chosen_);
    opaque_ = {as<F64>(low.v[0]), as<F64>(low.v[1]), as<F64>(low.v[2])};
    clear_ = {as<F64>(low.v[3]), as<F64>(high.v[0]), as<F64>(high.v[1])};
    transparent_ = as<F64>(high.v[2]);
    index_behind_ = as<F64>(high.v[3]);
    active_ = active_lanes(chosen_);
  }

  /// interpolated_normal() where there is one.
  [[nodiscard]] V3f shading_normals(const std::uint32_t (&ids)[kLanes], F64 u, F64 v) const {
    if (query_.corner_normals == nullptr) return ng_;
    alignas(64) std::int64_t smooth[kLanes];
    for (int i = 0; i < kLanes; ++i) {
      const std::uint32_t* corners = query_.corner_normals + std::size_t{3} * ids[i];
      constexpr std::uint32_t kNone = 0xFFFFFFFFU;
      smooth[i] = corners[0] != kNone && corners[1] != kNone && corners[2] != kNone ? -1 : 0;
    }
    V3 n[3];
    for (std::size_t c = 0; c < 3; ++c) {
      n[c] = wide(read_threes([&](int i) {  // where there is none, any will do
        return query_.normals + (smooth[i] != 0 ? std::size_t{3} * query_.corner_normals[std::size_t{3} * ids[i] + c] : 0);
      }));
    }
    const V3 sum = (1.0 - u - v) * n[0] + u * n[1] + v * n[2];
    const F64 squared = dot(sum, sum);
    return select(load<I64>(smooth) & (squared > 0.0), narrow(sum / root(squared)), ng_);
  }

  /// make_bsdf(): sides, the two axes and what happens at the border.
  void look_across() {
    const I64 front = dot(wide(ng_), wo_) >= 0.0;
    ng_ = select(front, ng_, -ng_);
    const F32 along = n_.x * ng_.x + n_.y * ng_.y + n_.z * ng_.z;
    const I64 turned = __builtin_convertvector(along < 0.0F, I64);
    n_ = select(turned, -n_, n_);
    cos_o_ = smaller(dot(wide(n_), wo_), all(1.0));
    const I64 hidden = ~(cos_o_ > 0.0);
    n_ = select(hidden, ng_, n_);
    const F64 flat = dot(wide(ng_), wo_);
    const F64 clamped = select(flat < 0x1p-100, all(0x1p-100), select(1.0 < flat, all(1.0), flat));
    cos_o_ = select(hidden, clamped, cos_o_);
    eta_o_ = select(front, all(1.0), index_behind_);
    eta_t_ = select(front, index_behind_, all(1.0));

    const V3 n = wide(n_);
    mirror_ = narrow(normalized((2.0 * cos_o_) * n - wo_));
    border_ = fresnel_of(cos_o_, eta_o_, eta_t_);
    const F64 ratio = eta_o_ / eta_t_;
    const V3f bent = narrow(normalized(ratio * (cos_o_ * n - wo_) - border_.cos_t * n));
    refracted_ = select(border_.total, zero_vector(), bent);
    radiance_scale_ = query_.radiance_scaling ? ratio * ratio : all(1.0);
    through_share_ = transparent_ * (1.0 - border_.reflectance);
  }

  /// Emitters::may_lie_along(): both axes have the box in common.
  struct EmitterBox {
    F64 below[3], above[3];
  };
  [[nodiscard]] EmitterBox emitter_box() const {
    const V3 lo{all(query_.emitters_lo[0]), all(query_.emitters_lo[1]), all(query_.emitters_lo[2])};
    const V3 hi{all(query_.emitters_hi[0]), all(query_.emitters_hi[1]), all(query_.emitters_hi[2])};
    const V3& p = point_.p;
    const V3 to_lo = absolute(lo - p), to_hi = absolute(hi - p);
    const V3 far{larger(to_lo.x, to_hi.x), larger(to_lo.y, to_hi.y), larger(to_lo.z, to_hi.z)};
    const V3 coordinates = absolute(p) + absolute(lo) + absolute(hi);
    const F64 margin = (2.0 * query_.axis_width) * root(dot(far, far)) +
                       0x1p-40 * (coordinates.x + coordinates.y + coordinates.z);
    return {{lo.x - margin - p.x, lo.y - margin - p.y, lo.z - margin - p.z},
            {hi.x + margin - p.x, hi.y + margin - p.y, hi.z + margin - p.z}};
  }
  static I64 may_lie_along(const EmitterBox& box, const V3f& axis) {
    const V3 wide_axis = wide(axis);
    const F64 d[3] = {wide_axis.x, wide_axis.y, wide_axis.z};
    F64 enter{}, leave = all(__builtin_inf());
    I64 beside{};
    for (int k = 0; k < 3; ++k) {
      const I64 level = d[k] == 0.0;
      beside |= level & ((box.below[k] > 0.0) | (box.above[k] < 0.0));
      const F64 t0 = box.below[k] / d[k], t1 = box.above[k] / d[k];
      enter = select(level, enter, larger(enter, smaller(t0, t1)));
      leave = select(level, leave, smaller(leave, larger(t0, t1)));
    }
    return ~beside & ~(enter > leave);
  }

  /// Lanes that a light may be seen in: few, and left to VertexShader. For places of lights a wide cone will do.
  [[nodiscard]] I64 light_may_come() const {
    I64 found{};
    if (query_.emitter_sampling) {
      const EmitterBox box = emitter_box();
      found = may_lie_along(box, mirror_);
      if (any(transparent_ > 0.0)) found |= (transparent_ > 0.0) & may_lie_along(box, refracted_);
    }
    const V3 mirror = wide(mirror_), refracted = wide(refracted_);
    for (std::size_t i = 0; i < query_.point_light_count; ++i) {
      const double* place = query_.point_lights + 3 * i;
      const V3 way = V3{all(place[0]), all(place[1]), all(place[2])} - point_.p;
      const F64 near = 0.999 * root(dot(way, way));
      found |= ~((dot(mirror, way) < near) & (dot(refracted, way) < near));
    }
    return found & active_;
  }

  /// sample_bsdf(): the axis itself, its value and density.
  LaneNext scatter() {
    const I64 through = choose_sides();
    LaneNext next;
    next.wi = select(through, refracted_, mirror_);
    const F64 side = dot(wide(ng_), wide(next.wi));
    const F64 peak = all(query_.peak);
    V3 f_cos = cos_o_ * ((peak / cos_o_) * (opaque_ + border_.reflectance * clear_));
    next.pdf = (1.0 - through_share_) * peak;
    I64 there = side > 0.0;
    next.scale = all(1.0);
    if (any(through)) {
      const F64 cos_t = border_.cos_t;
      const F64 reflectance = fresnel_of(cos_t, eta_t_, eta_o_).reflectance;
      const V3 across = cos_t * ((radiance_scale_ * ((1.0 - reflectance) * peak / cos_t)) * clear_);
      f_cos = select(through, across, f_cos);
      next.pdf = select(through, through_share_ * peak, next.pdf);
      next.scale = select(through, radiance_scale_, next.scale);
      there = select(through, (side < 0.0) & (cos_t > 0.0), there);
    }
    next.goes_on = active_ & there & ~is_zero(f_cos);
    next.throughput = path_.throughput * (f_cos / next.pdf);
    next.scale = path_.scale * next.scale;
    return next;
  }

  /// Lanes whose rays go through the border. A number is drawn only where that is open.
  [[nodiscard]] I64 choose_sides() const {
    const I64 surely = through_share_ >= 1.0;
    const I64 open = active_ & ~surely & (through_share_ > 0.0);
    alignas(64) double drawn[kLanes];
    for (int i = 0; i < kLanes; ++i) drawn[i] = open[i] != 0 ? query_.number(path(i), query_.side_dimension) : 1.0;
    return surely | (open & (load<F64>(drawn) < through_share_));
  }

  /// survives_roulette() of each lane.
  void play(LaneNext& next) {
    const F64 most = largest(next.throughput);
    for (int i = 0; i < chosen_.count; ++i) {
      const std::uint32_t reflections = path(i).bounce + 1U;
      if (next.goes_on[i] == 0 || reflections <= query_.bounces_before_roulette) continue;
      const double p = query_.roulette_factor * most[i] / next.scale[i];
      if (!(p < 1.0)) continue;
      if (query_.number(path(i), query_.roulette_dimension) >= p) {
        next.goes_on[i] = 0;
        ++counts_.roulette_ends;
        continue;
      }
      next.throughput.x[i] /= p;
      next.throughput.y[i] /= p;
      next.throughput.z[i] /= p;
    }
  }

  const AxisQuery& query_;
  AxisCounts& counts_;
  LaneChoice chosen_;
  std::uint32_t ids_[kLanes];  ///< of the triangles that the paths met
  LanePaths path_;
  LanePoint point_;
  V3f ng_, n_;  ///< on the side of the viewer
  V3f mirror_, refracted_;
  V3 wo_, opaque_, clear_;
  F64 transparent_, index_behind_, cos_o_, eta_o_, eta_t_, radiance_scale_, through_share_;
  LaneFresnel border_;
  I64 active_;  ///< lanes with a vertex
};

void shade_axis_lanes(const AxisQuery& query, AxisCounts& counts) {
  for (std::size_t first = 0; first < query.chosen_count; first += kLanes) {
    AxisBatch(query, counts, first).run();
  }
}

}  // namespace
}  // namespace raykiln::render
