// Values of textures at points of triangles.
#pragma once

#include <cstdint>
#include <optional>

#include "raykiln/scene/scene.hpp"
#include "raykiln/scene/surface_textures.hpp"

namespace raykiln::render {

class TexturePyramids;  // texture_pyramid.hpp

/// A point of triangle `id`: barycentrics of its second and third corner.
struct TrianglePlace {
  std::uint32_t id = 0;
  double u = 0.0, v = 0.0;
  /// Where textures are read by footprint; null: exactly at the point.
  const TexturePyramids* pyramids = nullptr;
  double footprint = 0.0;  ///< squared width of what the path's pixel covers, over twice the triangle's area
};

/// Linear value of `use` there: bilinear between the middles of texels, or the texel itself; with a footprint of
/// the copy of the picture whose texels are half as wide as that. 1 where the triangle has no coordinates.
[[nodiscard]] Rgbd texture_value(const SurfaceTextures& textures, const TextureUse& use,
                                 const TrianglePlace& at);

/// Linear value of a picture at (u, v), for tests and tools.
[[nodiscard]] Rgbd texture_value(const TextureImage& image, const TextureUse& use, double u,
                                 double v);

/// Writes to `painted` what `material`, number `id`, is at this place, its emission exactly. Its name is left alone.
void paint(const SurfaceTextures& textures, const Material& material, std::uint32_t id,
           const TrianglePlace& at, Material& painted);

/// Factor of a material's emission at this place; 1 without a texture.
[[nodiscard]] Rgbd emission_factor(const SurfaceTextures& textures, std::uint32_t material,
                                   const TrianglePlace& at);

/// The shading normal `ns` as the material's normal texture bends it; nothing where it does not.
[[nodiscard]] std::optional<Vec3f> mapped_normal(const SurfaceTextures& textures,
                                                 const TriangleMesh& mesh, std::uint32_t material,
                                                 const TrianglePlace& at, const Vec3f& ns);

/// Mean over all texels of the largest channel.
[[nodiscard]] double mean_largest_channel(const TextureImage& image);

}  // namespace raykiln::render
