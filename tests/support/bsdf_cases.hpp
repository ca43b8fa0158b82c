// Materials and directions that tests of the BSDF go through.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "raykiln/sampling/warp.hpp"
#include "raykiln/shading/bsdf.hpp"
#include "raykiln/shading/microfacet_bsdf.hpp"

namespace raykiln::render::support {

struct NamedMaterial {
  std::string name;
  Material material;
};

inline Material make_material(float diffuse, float specular, float transparent, double exponent,
                              float index = 1.5F) {
  Material m;
  m.diffuse = Rgb(diffuse);
  m.specular = Rgb(specular);
  m.transparent = transparent;
  m.specular_exp = exponent;
  m.index_of_refraction = index;
  return m;
}

inline std::vector<NamedMaterial> lobe_materials() {
  Material coloured = make_material(0.0F, 0.0F, 0.4F, 20.0);
  coloured.diffuse = {0.5F, 0.0F, 0.1F};
  coloured.specular = {0.1F, 0.4F, 0.0F};
  return {{"diffuse opaque", make_material(0.8F, 0.0F, 0.0F, 1.0)},
          {"diffuse transparent", make_material(0.8F, 0.0F, 1.0F, 1.0)},
          {"phong 1", make_material(0.0F, 1.0F, 0.0F, 1.0)},
          {"phong 10", make_material(0.0F, 1.0F, 0.0F, 10.0)},
          {"phong 1000", make_material(0.0F, 1.0F, 0.0F, 1000.0)},
          {"glass 50", make_material(0.0F, 1.0F, 1.0F, 50.0)},
          {"glass 50 reversed", make_material(0.0F, 1.0F, 1.0F, 50.0, 1.0F / 1.5F)},
          {"index 1", make_material(0.0F, 1.0F, 1.0F, 5.0, 1.0F)},
          {"all four", make_material(0.3F, 0.4F, 0.5F, 30.0)},
          {"weights 0.999999 and 1e-6", make_material(0.999999F, 1e-6F, 0.0F, 10.0)},
          {"coloured", coloured}};
}

inline const Vec3f kUp{0.0F, 0.0F, 1.0F};

/// Unit direction at so many degrees from +z, towards an oblique azimuth.
inline Vec3f at_degrees(double degrees) {
  const double theta = degrees * kPi / 180.0;
  return Vec3f(Vec3d(0.8 * std::sin(theta), -0.6 * std::sin(theta), std::cos(theta)));
}

inline constexpr BsdfModel kSeedBsdf{.direction_sampling = DirectionSampling::kBsdf,
                                     .light = kSeedModel};
inline constexpr BsdfModel kPhysicalBsdf{};

struct NamedModel {
  std::string name;
  BsdfModel model;
};

/// Both light models, and each switch of the physical one turned by itself.
inline std::vector<NamedModel> light_models() {
  std::vector<NamedModel> list{{"physical", kPhysicalBsdf}, {"seed", kSeedBsdf}};
  for (int i = 0; i < 4; ++i) {
    BsdfModel model;
    if (i == 0) model.light.phong = PhongCosine::kOverCosO;
    if (i == 1) model.light.fresnel = FresnelFormula::kSchlick;
    if (i == 2) model.light.radiance_scaling = false;
    if (i == 3) model.light.diffuse_sampling = DiffuseSampling::kUniform;
    list.push_back({render::name(model.light), model});
  }
  return list;
}

inline Bsdf bsdf_at(const Material& material, const Vec3f& wo, const BsdfModel& model = {}) {
  return make_bsdf(material, kUp, kUp, wo, model);
}

/// Opaque with both layers, a rough metal, a sheet and a body of glass, a leaf and one that is clear in part.
inline std::vector<NamedMaterial> facet_materials() {
  Material plastic;
  plastic.model = SurfaceModel::kMicrofacet;
  plastic.diffuse = {0.6F, 0.3F, 0.1F};
  plastic.specular = Rgb(0.04F);
  plastic.facets.edge = 1.0F;
  Material metal = plastic;
  metal.diffuse = Rgb(0.0F);
  metal.specular = {0.9F, 0.6F, 0.3F};
  Material sheet = plastic;
  sheet.transparent = 0.6F;
  sheet.index_of_refraction = 1.5F;
  sheet.facets.tint = {0.9F, 0.5F, 0.7F};
  Material body = sheet;
  body.transparent = 1.0F;
  body.facets.thin = false;
  Material leaf = plastic;
  leaf.facets.diffuse_through = {0.3F, 0.5F, 0.8F};
  Material clear_leaf = leaf;
  clear_leaf.transparent = 0.3F;
  return {{"plastic", plastic}, {"metal", metal}, {"sheet", sheet}, {"body", body},
          {"leaf", leaf}, {"clear leaf", clear_leaf}};
}

inline MicrofacetBsdf facets_at(Material material, double roughness, const Vec3f& wo,
                                const BsdfModel& model = {}) {
  material.facets.roughness = roughness;
  return make_microfacet_bsdf(material, kUp, kUp, wo, model);
}

inline VertexKey numbered(std::uint64_t i, std::uint64_t seed = 1) {
  return vertex_key(path_key(seed, i, 0), 0, 0);
}

}  // namespace raykiln::render::support
