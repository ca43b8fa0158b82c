#include <algorithm>
#include <vector>

#include "raykiln/render/render.hpp"

namespace raykiln::render {
namespace {

/// From here on the share of views so flat that weights grow is below 1e-8: 1/exponent of them.
constexpr double kSharpExponent = 1e8;

/// One flag a material: does a triangle use it and does it reflect like a Phong lobe?
std::vector<bool> specular_in_use(const Scene& scene) {
  std::vector<bool> used(scene.materials.size(), false);
  for (const std::uint32_t id : scene.mesh.material_ids) used[id] = true;
  for (std::size_t i = 0; i < used.size(); ++i) {
    const Rgb& s = scene.materials[i].specular;
    used[i] = used[i] && std::max({s.x, s.y, s.z}) > 0.0F;
  }
  return used;
}

}  // namespace

std::vector<LightModelWarning> light_model_warnings(const LightModel& model, const Scene& scene) {
  const std::vector<bool> specular = specular_in_use(scene);
  std::size_t broad = 0, refracting = 0;
  for (std::size_t i = 0; i < specular.size(); ++i) {
    if (!specular[i]) continue;
    const Material& m = scene.materials[i];
    broad += m.specular_exp < kSharpExponent ? 1U : 0U;
    refracting += m.transparent > 0.0F && m.index_of_refraction != 1.0F ? 1U : 0U;
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
