#include "rows.hpp"
#include "sources.hpp"

namespace raykiln::render {
namespace {

Judgement judge(const EffectView& view) {
  if (view.use.lights_without_surface() == 0)
    return {false, "no point, spot or directional light has power above 0"};
  if (reflecting_material(view) == nullptr) return {false, "no surface reflects"};
  return {true, std::to_string(view.scene.mesh.triangles.size()) +
                    " triangles may stand before such lights"};
}

void provoke(const EffectExample& at) { row_of(Effect::kPointLights).provoke(at); }

}  // namespace

const EffectRow kPointLightShadowsRow{.effect = Effect::kPointLightShadows,
                                      .name = "point_light_shadows",
                                      .left_out = "shadow rays to point, spot and directional lights",
                                      .grade = Grade::kUnbounded,
                                      .judge = judge,
                                      .provoke = provoke};

}  // namespace raykiln::render
