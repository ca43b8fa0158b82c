// From the parameters of file formats to those of raykiln. The reasons are in the module's README.
#pragma once

#include <optional>
#include <string>

#include "raykiln/scene/metallic_roughness.hpp"

namespace raykiln::render::io {

/// Sharp enough to look like a polished surface, broad enough to be sampled well.
inline constexpr double kPolishedExponent = 1e5;
inline constexpr double kMaxExponent = 1e10;

/// What an MTL file says of one material.
struct MtlMaterial {
  std::string name;
  Rgbd kd{0.8};
  Rgbd ks{0.0};
  std::optional<Rgbd> ke;
  Rgbd tf{1.0};
  double ns = 10.0;
  std::optional<double> ni;
  std::optional<double> opacity;  ///< d, or 1 - Tr
  bool masked = false;            ///< a texture says where the surface is: opacity is coverage
  int illum = 2;
};
[[nodiscard]] Material to_material(const MtlMaterial& mtl);

/// What glTF's metallic-roughness model and the material extensions say of one material.
struct GltfMaterial {
  std::string name;
  Rgbd base_color{1.0};
  double alpha = 1.0;  ///< coverage; 1 unless the alpha mode is BLEND or MASK
  double metallic = 1.0;
  double roughness = 1.0;
  Rgbd emissive{0.0};
  double emissive_strength = 1.0;
  double ior = 1.5;
  double transmission = 0.0;
  double diffuse_transmission = 0.0;
  Rgbd diffuse_transmission_color{1.0};
  double specular = 1.0;
  Rgbd specular_color{1.0};
  double thickness = 0.0;  ///< above 0: a body
  bool double_sided = false;
  Rgbd absorption{0.0};    ///< of its inside, m^-1
};
[[nodiscard]] MetallicRoughness metallic_roughness(const GltfMaterial& gltf);
/// Has it a front alone? Not what light goes through: it has to get out again.
[[nodiscard]] bool is_one_sided(const GltfMaterial& gltf);
/// Of microfacets.
[[nodiscard]] Material to_material(const GltfMaterial& gltf);
/// The nearest of the seed's model: what a sidecar that names a field of that model starts from.
[[nodiscard]] Material to_phong(const GltfMaterial& gltf);

/// Share of its specular weight, for each channel, that the base colour multiplies.
[[nodiscard]] Rgb specular_tint(const GltfMaterial& gltf);

/// Exponent of the lobe about the mirror direction that looks like roughness r:
/// a Blinn-Phong lobe about the half vector with exponent 2/r^4 - 2 (alpha = r^2) is about four
/// times as broad about the mirror direction. In [0, kMaxExponent].
[[nodiscard]] double exponent_of_roughness(double roughness);

/// Largest component of diffuse + specular.
[[nodiscard]] float largest_albedo(const Material& material);

}  // namespace raykiln::render::io
