#include <algorithm>

#include "rows.hpp"
#include "sources.hpp"

namespace raykiln::render {
namespace {

Judgement judge(const EffectView& view) {
  const Material* m = find_material(view, [](const Material& c) {
    return has_phong_lobe(c) && is_sharp(c) && c.transparent < 1.0F;
  });
  return of_surface(view, m,
                    m != nullptr ? says(*m, "specular with exponent", m->specular_exp) : "",
                    "no opaque material in use has a specular lobe from exponent 1e8 on");
}

void provoke(const EffectExample& at) {
  Material& m = at.scene.materials[at.material];
  m.specular = Rgb(0.8F);
  m.specular_exp = 1e10;
  m.transparent = std::min(m.transparent, 0.5F);
}

}  // namespace

const EffectRow kMirrorsRow{
    .effect = Effect::kMirrors,
    .name = "mirrors",
    .left_out =
        "Phong lobes from exponent 1e8 on, reflected by surfaces that are not wholly transparent",
    .grade = Grade::kBounded,
    .judge = judge,
    .provoke = provoke};

}  // namespace raykiln::render
