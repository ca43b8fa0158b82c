// Bodies that may focus light: spheres about connected mirrors and clear borders.
#pragma once

#include <cstddef>
#include <vector>

#include "raykiln/math/vec.hpp"
#include "raykiln/scene/scene.hpp"

namespace raykiln::render {

/// The sphere about a body, metres.
struct CausticCaster {
  Vec3d centre{0.0};
  double radius = 0.0;
};

inline constexpr std::size_t kMostCasters = 8;

/// Does a surface of this material send on half or more of what it meets, in one or two directions that are sharp?
[[nodiscard]] bool casts_caustics(const Material& material);

/// Connected triangles of such materials are a body: where corners lie in the same place. Bodies within the sphere
/// of another are part of it; of more than kMostCasters the largest are taken. Beyond a million (2^20) triangles all are
/// one body, so that memory and time stay bounded. The order depends on the scene alone.
[[nodiscard]] std::vector<CausticCaster> find_caustic_casters(const Scene& scene);

}  // namespace raykiln::render
