// Points on triangles, origins and ends of rays, directions about normals, of kLanes vertices at once: surface_point.cpp,
// frame.hpp and warp.cpp say why; the order of operations here is theirs, and so is every bit.
#pragma once

#include "lane_path.hpp"
#include "lane_rows.hpp"
#include "raykiln/sampling/turn_series.hpp"

namespace raykiln::render {
namespace {

constexpr double kUnit = 0x1p-24;
constexpr double gamma_of(int n) { return n * kUnit / (1.0 - n * kUnit); }
constexpr double kLanePi = 3.14159265358979323846;

struct LanePoint {
  V3 p, ng;
  V3 corner;  ///< the first one
  F64 twice_area, clearance;
  V3 inwards;
};

/// away_from_edges() of one lane.
inline void move_inwards(LanePoint& point, const V3 (&p)[3], const F64 (&b)[3], int lane) {
  double least[3], corner[3][3], share[3];
  bool near = false;
  for (int i = 0; i < 3; ++i) {
    corner[i][0] = p[i].x[lane];
    corner[i][1] = p[i].y[lane];
    corner[i][2] = p[i].z[lane];
    share[i] = b[i][lane];
  }
  for (int i = 0; i < 3; ++i) {
    double edge[3];
    for (int k = 0; k < 3; ++k) edge[k] = corner[(i + 2) % 3][k] - corner[(i + 1) % 3][k];
    const double squared = edge[0] * edge[0] + edge[1] * edge[1] + edge[2] * edge[2];
    least[i] = 4.0 * point.clearance[lane] * __builtin_sqrt(squared) / point.twice_area[lane];
    near = near || share[i] < least[i];
  }
  if (!near) return;
  for (double& l : least) l = 1.0 / 3.0 < l ? 1.0 / 3.0 : l;
  const double rest = 1.0 - least[0] - least[1] - least[2];
  double shift[3] = {0.0, 0.0, 0.0};
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) shift[k] += (least[i] + (rest - 1.0) * share[i]) * corner[i][k];
  }
  point.inwards.x[lane] = shift[0];
  point.inwards.y[lane] = shift[1];
  point.inwards.z[lane] = shift[2];
}

inline LanePoint points_on(const LaneMesh& mesh, const std::uint32_t (&ids)[kLanes], F64 u, F64 v) {
  V3 p[3];
  for (std::size_t c = 0; c < 3; ++c) {
    p[c] = wide(read_threes([&](int i) { return mesh.positions + std::size_t{3} * mesh.triangles[std::size_t{3} * ids[i] + c]; }));
  }
  const F64 b[3] = {1.0 - u - v, u, v};
  const V3 part[3] = {b[0] * p[0], b[1] * p[1], b[2] * p[2]};
  LanePoint point;
  point.corner = p[0];
  point.p = part[0] + part[1] + part[2];
  const V3 normal = cross(p[1] - p[0], p[2] - p[0]);
  point.twice_area = root(dot(normal, normal));
  point.ng = normal / point.twice_area;
  const V3 bound = all(gamma_of(7)) * (absolute(part[0]) + absolute(part[1]) + absolute(part[2]));
  F64 reach{};
  for (const V3& corner : p) reach = larger(reach, largest(absolute(corner - point.p)));
  point.clearance = dot(absolute(point.ng), bound) + gamma_of(4) * reach;
  point.inwards = {F64{}, F64{}, F64{}};
  const I64 clear = smaller(smaller(b[0], b[1]), b[2]) * point.twice_area >=
                    4.0 * 3.47 * point.clearance * reach;
  for (int i = 0; i < kLanes; ++i) {
    if (clear[i] == 0) move_inwards(point, p, b, i);
  }
  return point;
}

/// The next float away from 0 on the side of `offset`'s sign; the nearest where that is 0.
inline F32 round_away(F64 value, F64 offset) {
  const F32 near = narrow(value);
  const I32 bits = as<I32>(near);
  const I32 up = near > 0.0F ? bits + 1 : bits - 1;
  const I32 down = near > 0.0F ? bits - 1 : bits + 1;
  const I32 infinite = (bits & 0x7FFFFFFF) >= 0x7F800000;
  const I32 zero = near == 0.0F;
  const I32 next_up = zero ? I32{} + 1 : up;
  const I32 next_down = zero ? I32{} + static_cast<std::int32_t>(0x80000001U) : down;
  const I32 rises = __builtin_convertvector(offset > 0.0, I32);
  const I32 falls = __builtin_convertvector(offset < 0.0, I32);
  const I32 moved = rises ? next_up : (falls ? next_down : bits);
  return as<F32>(infinite ? bits : moved);
}

inline V3f lifted(const LanePoint& point, F64 height) {
  const V3 offset = height * point.ng;
  const V3 moved = point.p + point.inwards + offset;
  return {round_away(moved.x, offset.x), round_away(moved.y, offset.y), round_away(moved.z, offset.z)};
}

inline V3f ray_origins(const LanePoint& point, const V3& direction) {
  return lifted(point, select(dot(point.ng, direction) < 0.0, -point.clearance, point.clearance));
}

inline V3f ray_ends(const LanePoint& point, const V3& origin) {
  const V3 way = absolute(point.p + point.inwards - origin);
  const F64 sinks = 2.0 * kUnit * dot(absolute(point.ng), way) + 16.0 * 0x1p-53 * largest(way);
  const F64 height = point.clearance + sinks;
  return lifted(point, select(dot(point.ng, origin - point.p) < 0.0, -height, height));
}

struct Turns {
  F64 cosine, sine;
};
inline Turns turns(F64 v) {
  const F64 quarter = (4.0 * v + turn_series::kToInteger) - turn_series::kToInteger;
  const F64 x = 2.0 * kLanePi * (v - 0.25 * quarter);
  const F64 x2 = x * x;
  F64 s = all(turn_series::kSine[0]), c = all(turn_series::kCosine[0]);
  for (int k = 1; k < turn_series::kTerms; ++k) {
    s = s * x2 + turn_series::kSine[k];
    c = c * x2 + turn_series::kCosine[k];
  }
  s = x + x * (x2 * s);
  c = 1.0 + x2 * c;
  const I64 odd = (quarter == 1.0) | (quarter == 3.0);
  const F64 cosine = select(odd, s, c), sine = select(odd, c, s);
  const I64 cosine_turns = (quarter == 1.0) | (quarter == 2.0);
  const I64 sine_turns = (quarter == 2.0) | (quarter == 3.0);
  return {select(cosine_turns, -cosine, cosine), select(sine_turns, -sine, sine)};
}

inline V3f around_axes(const V3f& n, F64 x, F64 v) {
  const F32 sign = as<F32>((as<I32>(n.z) & static_cast<std::int32_t>(0x80000000U)) | 0x3F800000);
  const F32 a = -1.0F / (sign + n.z);
  const F32 b = n.x * n.y * a;
  const V3 s{wide(1.0F + sign * n.x * n.x * a), wide(sign * b), wide(-sign * n.x)};
  const V3 t{wide(b), wide(sign + n.y * n.y * a), wide(-n.y)};
  const F64 sine = root(x * (2.0 - x));
  const Turns turn = turns(v);
  return narrow(sine * turn.cosine * s + sine * turn.sine * t + (1.0 - x) * wide(n));
}

}  // namespace
}  // namespace raykiln::render
