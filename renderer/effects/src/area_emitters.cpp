#include "rows.hpp"
#include "sources.hpp"

namespace raykiln::render {
namespace {

Judgement judge(const EffectView& view) {
  const Material* m = emitting_material(view);
  if (m == nullptr) return {false, "no triangle has a material with emission above 0"};
  return {true, says(*m, "emission", m->emission)};
}

void provoke(const EffectExample& at) {
  at.scene.materials[at.material].emission = {5.0F, 4.0F, 3.0F};
}

}  // namespace

const EffectRow kAreaEmittersRow{.effect = Effect::kAreaEmitters,
                                 .name = "area_emitters",
                                 .left_out = "looking emission up at hits",
                                 .grade = Grade::kBounded,
                                 .judge = judge,
                                 .provoke = provoke};

}  // namespace raykiln::render
