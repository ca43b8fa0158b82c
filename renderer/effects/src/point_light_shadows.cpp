#include "rows.hpp"
#include "sources.hpp"

namespace raykiln::render {
namespace {

Judgement judge(const EffectView& view) {
  const std::uint64_t lights = view.use.shining_point_lights;
  if (lights == 0) return {false, "no point light has power above 0"};
  if (reflecting_material(view) == nullptr) return {false, "no surface reflects"};
  return {true, std::to_string(view.scene.mesh.triangles.size()) + " triangles may stand before point lights"};
}

void provoke(const EffectExample& at) { row_of(Effect::kPointLights).provoke(at); }

}  // namespace

const EffectRow kPointLightShadowsRow{.effect = Effect::kPointLightShadows,
                                      .name = "point_light_shadows",
                                      .left_out = "shadow rays to point lights",
                                      .grade = Grade::kUnbounded,
                                      .judge = judge,
                                      .provoke = provoke};

}  // namespace raykiln::render
