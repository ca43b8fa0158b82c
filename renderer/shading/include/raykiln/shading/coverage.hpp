// How much of a surface is there: alpha, and surfaces that have a front alone.
#pragma once

#include <cstdint>

#include "raykiln/scene/scene.hpp"
#include "raykiln/shading/texture_lookup.hpp"

namespace raykiln::render {

/// Does the material leave parts of its surfaces open?
[[nodiscard]] bool has_open_parts(const Scene& scene, std::uint32_t material);

/// Share of a surface that is there at this place, [0, 1].
[[nodiscard]] double coverage_at(const Scene& scene, const TrianglePlace& at);

/// Mean of that over the texels of the material's picture.
[[nodiscard]] double mean_coverage(const Scene& scene, std::uint32_t material);

/// Where light passes straight through surfaces.
struct Gaps {
  const Scene* scene = nullptr;
  bool open_parts = false;  ///< what coverage leaves open
  bool back_faces = false;  ///< of surfaces with one side

  [[nodiscard]] bool any() const { return open_parts || back_faces; }

  /// Share of the light along a ray in this direction that meets the surface, [0, 1]; the rest goes on.
  /// Rays are those of a path or to a light, as they are traced: away from the eye.
  [[nodiscard]] double met(const TrianglePlace& at, const Vec3d& direction) const;
};

/// Those of a scene; its materials decide, whether a triangle has them or not.
[[nodiscard]] Gaps gaps_of(const Scene& scene);

}  // namespace raykiln::render
