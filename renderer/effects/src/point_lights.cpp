#include "rows.hpp"
#include "sources.hpp"

namespace raykiln::render {
namespace {

Judgement judge(const EffectView& view) {
  const std::uint64_t lights = view.use.shining_point_lights;
  if (lights == 0) return {false, "no point light has power above 0"};
  if (reflecting_material(view) == nullptr) return {false, "no surface reflects"};
  return {true, std::to_string(lights) + (lights == 1 ? " point light" : " point lights") +
                    " with power above 0"};
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
