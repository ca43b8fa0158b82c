#include <algorithm>

#include "rows.hpp"
#include "sources.hpp"

namespace raykiln::render {
namespace {

Judgement judge(const EffectView& view) {
  const Material* m = find_material(
      view, has_border);
  return of_surface(
      view, m,
      m != nullptr ? says(*m, "specular and transparent", static_cast<double>(m->transparent)) : "",
      "no specular material in use is transparent");
}

void provoke(const EffectExample& at) {
  Material& m = at.scene.materials[at.material];
  m.specular = Rgb(1.0F);
  m.transparent = std::max(m.transparent, 0.9F);
  m.specular_exp = 1e10;
  m.index_of_refraction = 1.5F;
}

}  // namespace

const EffectRow kRefractionRow{
    .effect = Effect::kRefraction,
    .name = "refraction",
    .left_out = "refracted directions, total internal reflection and indices of refraction",
    .grade = Grade::kBounded,
    .judge = judge,
    .provoke = provoke};

}  // namespace raykiln::render
