#include "raykiln/shading/surface_point.hpp"

#include <algorithm>
#include <array>

#include "raykiln/math/float_bits.hpp"

namespace raykiln::render {
namespace {

double largest_component(const Vec3d& v) {
  const Vec3d a = abs(v);
  return std::max({a.x, a.y, a.z});
}

Vec3f interpolated_normal(const TriangleMesh& mesh, std::uint32_t id, double u, double v,
                          const Vec3f& ng) {
  if (mesh.corner_normals.empty()) return ng;
  const auto& corner = mesh.corner_normals[id];
  if (corner[0] == kNoNormal || corner[1] == kNoNormal || corner[2] == kNoNormal) return ng;
  const Vec3d sum = (1.0 - u - v) * Vec3d(mesh.normals[corner[0]]) +
                    u * Vec3d(mesh.normals[corner[1]]) + v * Vec3d(mesh.normals[corner[2]]);
  const double squared = dot(sum, sum);
  return squared > 0.0 ? Vec3f(sum / std::sqrt(squared)) : ng;
}

/// How far from the edges of its triangle a ray starts, in clearances.
constexpr double kFromEdges = 4.0;

// Where two walls meet in a concave corner, the offset along one normal may leave the origin in or
// behind the other wall, and the ray escapes. So a ray that leaves a point near an edge starts
// farther inside of its triangle: no barycentric is below kFromEdges * clearance / height. Then it
// starts clear of every wall that meets this one at more than atan(1/kFromEdges) = 14 degrees.
// `twice_area` is the length of the cross product of two sides, `reach` the largest coordinate of
// p_i - point: no side is longer than 2 sqrt(3) reach, which tells most points without the sides' lengths.
Vec3d away_from_edges(const std::array<Vec3d, 3>& p, const std::array<double, 3>& b,
                      double twice_area, double clearance, double reach) {
  constexpr double kLongestSide = 3.47;  // 2 sqrt(3), and more than all roundings
  if (std::min({b[0], b[1], b[2]}) * twice_area >= kFromEdges * kLongestSide * clearance * reach) {
    return Vec3d(0.0);
  }
  std::array<double, 3> least{};
  bool near = false;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3d edge = p[(i + 2) % 3] - p[(i + 1) % 3];
    least[i] = kFromEdges * clearance * std::sqrt(dot(edge, edge)) / twice_area;
    near = near || b[i] < least[i];
  }
  if (!near) return Vec3d(0.0);
  for (double& l : least) l = std::min(l, 1.0 / 3.0);
  const double rest = 1.0 - least[0] - least[1] - least[2];
  Vec3d shift(0.0);
  for (std::size_t i = 0; i < 3; ++i) shift += (least[i] + (rest - 1.0) * b[i]) * p[i];
  return shift;
}

float round_away(double value, double offset) {
  if (offset > 0.0) return next_up(static_cast<float>(value));
  if (offset < 0.0) return next_down(static_cast<float>(value));
  return static_cast<float>(value);
}

/// The point away from near edges and at least |height| over the plane, on the side of its sign.
Vec3f lifted(const SurfacePoint& point, double height) {
  const Vec3d offset = height * point.ng;
  const Vec3d moved = point.p + point.inwards + offset;
  return {round_away(moved.x, offset.x), round_away(moved.y, offset.y),
          round_away(moved.z, offset.z)};
}

}  // namespace

// Two errors have to be cleared. The position itself: gamma_7 sum |b_i p_i| per coordinate bounds
// what float barycentrics and rounding do to it (Pharr, Jakob & Humphreys 2023, section 6.8.4).
// And the test of the own triangle against the new ray: the sheared differences p_i - o carry
// gamma_4 of the largest of them, which the first term misses where the coordinates are near 0.
SurfacePoint surface_point(const TriangleMesh& mesh, std::uint32_t id, double u, double v,
                           bool normals) {
  const auto& corner = mesh.triangles[id];
  const std::array<Vec3d, 3> p{Vec3d(mesh.positions[corner[0]]), Vec3d(mesh.positions[corner[1]]),
                               Vec3d(mesh.positions[corner[2]])};
  const std::array<double, 3> b{1.0 - u - v, u, v};
  SurfacePoint point;
  point.p = b[0] * p[0] + b[1] * p[1] + b[2] * p[2];
  const Vec3d normal = cross(p[1] - p[0], p[2] - p[0]);
  const double twice_area = length(normal);
  point.ng = normal / twice_area;
  const Vec3f ng(point.ng);
  point.ns = normals ? interpolated_normal(mesh, id, u, v, ng) : ng;
  point.material = mesh.material_ids[id];

  const Vec3d bound =
      gamma_bound(7) * (abs(b[0] * p[0]) + abs(b[1] * p[1]) + abs(b[2] * p[2]));
  double reach = 0.0;
  for (const Vec3d& vertex : p) reach = std::max(reach, largest_component(vertex - point.p));
  point.clearance = dot(abs(point.ng), bound) + gamma_bound(4) * reach;
  point.inwards = away_from_edges(p, b, twice_area, point.clearance, reach);
  return point;
}

Vec3f ray_origin(const SurfacePoint& point, const Vec3d& direction) {
  return lifted(point, dot(point.ng, direction) < 0.0 ? -point.clearance : point.clearance);
}

// end - origin is rounded once for each coordinate, by u |end_i - origin_i| at most: over the plane the
// far end sinks by u sum |n_i| |end_i - origin_i|. It starts from at least twice that (the second
// covers |end - point| and the roundings here). The triangle test, in double, moves its corners by
// 12 w of their largest distance from the origin (scalar_walk.hpp), w = 2^-53; 16 stand for it.
Vec3f ray_end(const SurfacePoint& point, const Vec3d& origin) {
  const Vec3d way = abs(point.p + point.inwards - origin);
  const double sinks =
      2.0 * kFloatUnit * dot(abs(point.ng), way) + 16.0 * 0x1p-53 * largest_component(way);
  const double height = point.clearance + sinks;
  return lifted(point, dot(point.ng, origin - point.p) < 0.0 ? -height : height);
}

}  // namespace raykiln::render
