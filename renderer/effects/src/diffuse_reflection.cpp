#include "rows.hpp"
#include "sources.hpp"

namespace raykiln::render {
namespace {

Judgement judge(const EffectView& view) {
  const Material* m = find_material(view, [](const Material& c) { return !is_black(c.diffuse); });
  return of_surface(view, m, m != nullptr ? says(*m, "diffuse", m->diffuse) : "",
                    "no material in use is diffuse");
}

void provoke(const EffectExample& at) {
  at.scene.materials[at.material].diffuse = {0.6F, 0.5F, 0.4F};
}

}  // namespace

const EffectRow kDiffuseReflectionRow{.effect = Effect::kDiffuseReflection,
                                      .name = "diffuse_reflection",
                                      .left_out = "the diffuse lobe on the side of the viewer",
                                      .grade = Grade::kBounded,
                                      .judge = judge,
                                      .provoke = provoke};

}  // namespace raykiln::render
