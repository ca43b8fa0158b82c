// A point on a triangle: position with an error bound, normals, and where rays may start.
#pragma once

#include <cstdint>

#include "raykiln/math/vec.hpp"
#include "raykiln/scene/scene.hpp"

namespace raykiln::render {

struct SurfacePoint {
  Vec3d p{0.0};       ///< from the barycentrics, world space relative to Scene::origin, metres
  Vec3d ng{0.0};      ///< unit, as wound
  Vec3f ns{0.0F};     ///< unit; interpolated where all three corners have a normal, else ng
  double clearance = 0.0;  ///< distance from the plane at which a ray misses its own triangle
  Vec3d inwards{0.0};  ///< within the plane, away from an edge that is close; else 0
  std::uint32_t material = 0;
};

/// Point (1 - u - v) p0 + u p1 + v p2 of triangle `id`. Without `normals`, ns is ng.
[[nodiscard]] SurfacePoint surface_point(const TriangleMesh& mesh, std::uint32_t id, double u,
                                         double v, bool normals = true);

/// Origin of a ray that leaves `point` towards `direction`: moved along the geometric normal by
/// the clearance, to the side of the direction, away from near edges, and rounded outwards. No absolute length enters,
/// so that scaling a scene by a power of two scales origins exactly.
[[nodiscard]] Vec3f ray_origin(const SurfacePoint& point, const Vec3d& direction);

/// End of a ray from `origin` to `point`: the same on the side of `origin`, and farther from the plane
/// by what the far end of a ray moves when its direction is rounded. A ray o = origin,
/// d = end - origin, both in float, meets the point's own triangle at no t < 1.
[[nodiscard]] Vec3f ray_end(const SurfacePoint& point, const Vec3d& origin);

}  // namespace raykiln::render
