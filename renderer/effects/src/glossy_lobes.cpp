#include "rows.hpp"
#include "sources.hpp"

namespace raykiln::render {
namespace {

Judgement judge(const EffectView& view) {
  const Material* m =
      find_material(view, [](const Material& c) { return has_phong_lobe(c) && !is_sharp(c); });
  return of_surface(view, m,
                    m != nullptr ? says(*m, "specular with exponent", m->specular_exp) : "",
                    "no material in use has a specular lobe below exponent 1e8");
}

void provoke(const EffectExample& at) {
  Material& m = at.scene.materials[at.material];
  m.specular = {0.3F, 0.35F, 0.4F};
  m.specular_exp = 60.0;
}

}  // namespace

const EffectRow kGlossyLobesRow{
    .effect = Effect::kGlossyLobes,
    .name = "glossy_lobes",
    .left_out = "Phong lobes below exponent 1e8 and, without mirrors, choosing between lobes",
    .grade = Grade::kBounded,
    .judge = judge,
    .provoke = provoke};

}  // namespace raykiln::render
