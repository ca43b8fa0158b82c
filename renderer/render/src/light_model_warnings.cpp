#include <vector>

#include "raykiln/render/render.hpp"

namespace raykiln::render {

// Of mirrors the share of views so flat that weights grow is below 1e-8: 1/exponent of them.
std::vector<LightModelWarning> light_model_warnings(const LightModel& model, const Scene& scene) {
  std::size_t broad = 0, refracting = 0;
  for (const std::uint32_t id : use_of(scene).materials) {
    const Material& m = scene.materials[id];
    const bool facets = m.model == SurfaceModel::kMicrofacet;
    if (!facets && is_black(m.specular)) continue;
    broad += !facets && m.specular_exp < kMirrorExponent ? 1U : 0U;
    const bool bends = !facets || !m.facets.thin;
    refracting += bends && m.transparent > 0.0F && m.index_of_refraction != 1.0F ? 1U : 0U;
  }
  std::vector<LightModelWarning> warnings;
  if (model.phong == PhongCosine::kOverCosO && broad > 0) {
    warnings.push_back({"heavy_tailed",
                        "phong=over_cos_o has no finite variance where a glossy surface is seen near "
                        "grazing (" + std::to_string(broad) +
                            " materials): surfaces brighter than their surroundings, error bars too "
                            "small"});
  }
  if (!model.radiance_scaling && refracting > 0) {
    warnings.push_back({"not_conserving_refraction",
                        "radiance_scaling=false does not conserve energy where light is emitted, "
                        "scattered or seen inside glass (" + std::to_string(refracting) +
                            " materials): it gains the square of the index on the way out"});
  }
  return warnings;
}

}  // namespace raykiln::render
