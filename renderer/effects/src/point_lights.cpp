#include "rows.hpp"
#include "sources.hpp"

namespace raykiln::render {
namespace {

Judgement judge(const EffectView& view) {
  return of_lights(view, view.use.shining_point_lights, "point light");
}

void provoke(const EffectExample& at) {
  const Vec3f centre = 0.5F * (at.scene.bounds.lo + at.scene.bounds.hi);
  at.scene.point_lights.push_back({.name = "example",
                                   .position = centre + 0.31F * (at.scene.bounds.hi - centre),
                                   .intensity = Rgb(0.4F, 0.5F, 0.6F)});
}

}  // namespace

const EffectRow kPointLightsRow{.effect = Effect::kPointLights,
                                .name = "point_lights",
                                .left_out =
                                    "the loop over point lights at every hit and, where nothing "
                                    "else shines, what a last hit would need for it",
                                .grade = Grade::kBounded,
                                .judge = judge,
                                .provoke = provoke};

}  // namespace raykiln::render
