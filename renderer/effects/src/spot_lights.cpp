#include "rows.hpp"
#include "sources.hpp"

namespace raykiln::render {
namespace {

Judgement judge(const EffectView& view) {
  return of_lights(view, view.use.shining_spot_lights, "spot light");
}

void provoke(const EffectExample& at) {
  const Vec3f centre = 0.5F * (at.scene.bounds.lo + at.scene.bounds.hi);
  SpotLight light;
  light.name = "example";
  light.position = centre + 0.34F * (at.scene.bounds.hi - centre);
  light.intensity = Rgb(0.9F, 0.5F, 0.7F);
  light.axis = normalize(Vec3d(-0.3, -1.0, -0.4));
  light.inner_one_minus_cos = 0.1;
  light.outer_one_minus_cos = 0.6;
  light.range = 2.0F * length(at.scene.bounds.hi - at.scene.bounds.lo);
  at.scene.spot_lights.push_back(light);
}

}  // namespace

const EffectRow kSpotLightsRow{.effect = Effect::kSpotLights,
                       .name = "spot_lights",
                       .left_out = "the loop over spot lights at every hit",
                       .grade = Grade::kBounded,
                       .judge = judge,
                       .provoke = provoke};

}  // namespace raykiln::render
