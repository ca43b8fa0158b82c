#include <algorithm>

#include "rows.hpp"
#include "sources.hpp"

namespace raykiln::render {
namespace {

Judgement judge(const EffectView& view) {
  const Material* diffuse =
      find_material(view, [](const Material& c) { return !is_black(c.diffuse); });
  const Material* specular =
      find_material(view, is_specular);
  if (diffuse == nullptr || specular == nullptr)
    return {false, "the scene has not both diffuse and specular surfaces"};
  if (!reaches_two_surfaces(view)) return {false, "light does not come by way of two surfaces"};
  return {true, "specular " + named(*specular) + " may light diffuse " + named(*diffuse)};
}

void provoke(const EffectExample& at) {
  at.scene.materials[at.material].specular = Rgb(0.7F);
  at.scene.materials[at.material].specular_exp = 300.0;
  at.job.max_depth = std::max(at.job.max_depth, 3);
}

}  // namespace

const EffectRow kCausticsRow{.effect = Effect::kCaustics,
                             .name = "caustics",
                             .left_out =
                                 "telling lobes apart on the way: light that reaches a diffuse "
                                 "surface by way of a specular one",
                             .grade = Grade::kBounded,
                             .judge = judge,
                             .provoke = provoke};

}  // namespace raykiln::render
