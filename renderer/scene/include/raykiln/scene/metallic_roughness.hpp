// glTF's metallic-roughness parameters, and the material that they make.
#pragma once

#include "raykiln/scene/scene.hpp"

namespace raykiln::render {

struct MetallicRoughness {
  Rgb base{1.0F};          ///< colour, [0, 1]
  float metallic = 1.0F;   ///< [0, 1]
  double roughness = 1.0;  ///< [0, 1]
  Rgb f0{0.04F};           ///< reflectance at normal incidence of what is no metal, [0, 1]
  float edge = 1.0F;       ///< the same at grazing incidence
  float transmission = 0.0F;
  float through = 0.0F;    ///< diffuse transmission: share of the diffuse base that sends its light to the far side
  Rgb through_colour{1.0F};  ///< of that light
};

/// Sets the parts of a microfacet material that follow. Shares of the whole: metal m, clear (1 - m) T,
/// and the rest a dielectric over a diffuse base. Metal and dielectric reflect by Schlick's formula from
/// F0 to F90 with the same facets, so that their mixture is that of F0 and F90.
inline void mix_metal(const MetallicRoughness& from, Material& material) {
  const auto m = static_cast<double>(from.metallic), t = static_cast<double>(from.transmission);
  const double clear = (1.0 - m) * t, opaque = 1.0 - clear, dielectric = (1.0 - m) * (1.0 - t);
  const Rgbd base(from.base);
  material.transparent = static_cast<float>(clear);
  material.diffuse = material.specular = material.facets.diffuse_through = Rgb(0.0F);
  material.facets.edge = 0.0F;
  if (opaque > 0.0) {
    const auto through = static_cast<double>(from.through);
    material.diffuse = Rgb(dielectric * (1.0 - through) / opaque * base);
    material.facets.diffuse_through = Rgb(dielectric * through / opaque * Rgbd(from.through_colour));
    material.specular = Rgb((m * base + dielectric * Rgbd(from.f0)) / opaque);
    material.facets.edge =
        static_cast<float>((m + dielectric * static_cast<double>(from.edge)) / opaque);
  }
  material.facets.tint = from.base;
  material.facets.roughness = from.roughness;
}

}  // namespace raykiln::render
