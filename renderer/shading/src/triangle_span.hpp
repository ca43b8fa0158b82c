// Normal and area of a mesh's triangles, in double.
#pragma once

#include <cstdint>

#include "raykiln/scene/scene.hpp"

namespace raykiln::render {

/// Normal to the triangle, as long as twice its area.
inline Vec3d triangle_span(const TriangleMesh& mesh, std::uint32_t id) {
  const auto& corner = mesh.triangles[id];
  const Vec3d p0(mesh.positions[corner[0]]);
  return cross(Vec3d(mesh.positions[corner[1]]) - p0, Vec3d(mesh.positions[corner[2]]) - p0);
}

inline double triangle_area(const TriangleMesh& mesh, std::uint32_t id) {
  return 0.5 * length(triangle_span(mesh, id));
}

}  // namespace raykiln::render
