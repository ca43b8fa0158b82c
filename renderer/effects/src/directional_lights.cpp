#include "rows.hpp"
#include "sources.hpp"

namespace raykiln::render {
namespace {

Judgement judge(const EffectView& view) {
  return of_lights(view, view.use.shining_directional_lights, "directional light");
}

void provoke(const EffectExample& at) {
  at.scene.directional_lights.push_back({.name = "example",
                                         .direction = normalize(Vec3d(0.3, -0.5, -1.0)),
                                         .irradiance = Rgb(0.7F, 0.8F, 0.5F)});
}

}  // namespace

const EffectRow kDirectionalLightsRow{.effect = Effect::kDirectionalLights,
                       .name = "directional_lights",
                       .left_out = "the loop over directional lights at every hit",
                       .grade = Grade::kBounded,
                       .judge = judge,
                       .provoke = provoke};

}  // namespace raykiln::render
