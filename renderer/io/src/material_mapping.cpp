#include "material_mapping.hpp"

#include <algorithm>

namespace raykiln::render::io {
namespace {

// Lets the share `t` of the light through without a change of direction other than by refraction:
// the opaque lobes keep 1 - t, the sharp lobe gets t * tint and transmits.
void let_through(Material& material, double t, const Rgbd& tint) {
  const auto keep = static_cast<float>(1.0 - t);
  material.diffuse *= keep;
  material.specular = material.specular * keep + Rgb(tint * t);
  material.transparent = static_cast<float>(t);
}

}  // namespace

Material to_material(const MtlMaterial& mtl) {
  Material material;
  material.name = mtl.name;
  material.diffuse = Rgb(mtl.kd);
  const bool has_highlight = mtl.illum >= 2;  // 0: colour only, 1: Lambert
  material.specular = has_highlight ? Rgb(mtl.ks) : Rgb(0.0F);
  material.specular_exp = mtl.ns;
  material.emission = Rgb(mtl.ke.value_or(Rgbd(0.0)));
  const bool glass = mtl.illum == 4 || mtl.illum == 6 || mtl.illum == 7 || mtl.illum == 9;
  if (mtl.masked) material.coverage = static_cast<float>(mtl.opacity.value_or(1.0));
  const double t = mtl.masked ? 0.0 : 1.0 - mtl.opacity.value_or(glass ? 0.0 : 1.0);
  if (t > 0.0) {
    material.specular_exp = std::max(mtl.ns, kPolishedExponent);
    material.index_of_refraction = static_cast<float>(mtl.ni.value_or(glass ? 1.5 : 1.0));
    let_through(material, t, mtl.tf);
  }
  return material;
}

double exponent_of_roughness(double roughness) {
  const double r4 = roughness * roughness * roughness * roughness;
  if (r4 * kMaxExponent <= 0.5) return kMaxExponent;
  return std::clamp((2.0 / r4 - 2.0) / 4.0, 0.0, kMaxExponent);
}

namespace {

/// Reflectance at normal incidence of the part that is no metal.
Rgbd dielectric_f0(const GltfMaterial& gltf) {
  const double at_normal = (gltf.ior - 1.0) / (gltf.ior + 1.0);
  return glm::min(Rgbd(at_normal * at_normal) * gltf.specular_color, Rgbd(1.0)) * gltf.specular;
}

}  // namespace

MetallicRoughness metallic_roughness(const GltfMaterial& gltf) {
  return {.base = Rgb(gltf.base_color),
          .metallic = static_cast<float>(gltf.metallic),
          .roughness = gltf.roughness,
          .f0 = Rgb(dielectric_f0(gltf)),
          .edge = static_cast<float>(gltf.specular),
          .transmission = static_cast<float>(gltf.transmission),
          .through = static_cast<float>(gltf.diffuse_transmission),
          .through_colour = Rgb(gltf.diffuse_transmission_color)};
}

bool is_one_sided(const GltfMaterial& gltf) {
  const bool lets_light_through = gltf.transmission > 0.0 || gltf.diffuse_transmission > 0.0;
  return !gltf.double_sided && !lets_light_through && !(gltf.thickness > 0.0);
}

Material to_material(const GltfMaterial& gltf) {
  Material material;
  material.name = gltf.name;
  material.one_sided = is_one_sided(gltf);
  material.model = SurfaceModel::kMicrofacet;
  mix_metal(metallic_roughness(gltf), material);
  material.index_of_refraction = static_cast<float>(gltf.ior);
  material.emission = Rgb(gltf.emissive * gltf.emissive_strength);
  material.facets.thin = !(gltf.thickness > 0.0);
  if (!material.facets.thin) material.facets.absorption = Rgb(gltf.absorption);
  material.coverage = static_cast<float>(gltf.alpha);
  return material;
}

Material to_phong(const GltfMaterial& gltf) {
  const double m = gltf.metallic;
  const double dielectric = 1.0 - m;
  const double at_normal = (gltf.ior - 1.0) / (gltf.ior + 1.0);
  const Rgbd f0 =
      glm::min(Rgbd(at_normal * at_normal * gltf.specular) * gltf.specular_color, Rgbd(1.0));
  const double through = gltf.transmission;
  Material material;
  material.name = gltf.name;
  material.one_sided = is_one_sided(gltf);
  material.diffuse = Rgb(dielectric * (1.0 - through) * (1.0 - f0) * gltf.base_color);
  material.specular = Rgb(m * gltf.base_color +
                          dielectric * ((1.0 - through) * f0 + through * gltf.base_color));
  material.transparent = static_cast<float>(dielectric * through);
  material.specular_exp = exponent_of_roughness(gltf.roughness);
  if (through > 0.0) material.index_of_refraction = static_cast<float>(gltf.ior);
  material.emission = Rgb(gltf.emissive * gltf.emissive_strength);
  material.coverage = static_cast<float>(gltf.alpha);
  return material;
}

Rgb specular_tint(const GltfMaterial& gltf) {
  GltfMaterial black = gltf;
  black.base_color = Rgbd(0.0);
  const Rgb all = to_material(gltf).specular, untinted = to_material(black).specular;
  Rgb tint(0.0F);
  for (int c = 0; c < 3; ++c) {
    if (all[c] > 0.0F) tint[c] = std::clamp((all[c] - untinted[c]) / all[c], 0.0F, 1.0F);
  }
  return tint;
}

float largest_albedo(const Material& material) {
  if (material.model == SurfaceModel::kMicrofacet) {  // its layers share what arrives
    const Rgb both = material.diffuse + material.facets.diffuse_through;
    return std::max({both.x, both.y, both.z});
  }
  const Rgb sum = material.diffuse + material.specular;
  return std::max({sum.x, sum.y, sum.z});
}

}  // namespace raykiln::render::io
