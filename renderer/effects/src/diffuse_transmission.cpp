#include <algorithm>

#include "rows.hpp"
#include "sources.hpp"

namespace raykiln::render {
namespace {

Judgement judge(const EffectView& view) {
  const Material* m = find_material(
      view, [](const Material& c) {
        if (c.model == SurfaceModel::kMicrofacet) return !is_black(c.facets.diffuse_through);
        return !is_black(c.diffuse) && c.transparent > 0.0F;
      });
  if (m != nullptr && m->model == SurfaceModel::kMicrofacet) {
    return of_surface(view, m, says(*m, "diffuse transmission", m->facets.diffuse_through), "");
  }
  return of_surface(
      view, m,
      m != nullptr ? says(*m, "diffuse and transparent", static_cast<double>(m->transparent)) : "",
      "no diffuse material in use is transparent");
}

void provoke(const EffectExample& at) {
  Material& m = at.scene.materials[at.material];
  m.diffuse = {0.7F, 0.6F, 0.5F};
  m.transparent = std::max(m.transparent, 0.8F);
}

}  // namespace

const EffectRow kDiffuseTransmissionRow{
    .effect = Effect::kDiffuseTransmission,
    .name = "diffuse_transmission",
    .left_out = "the far hemisphere: light that comes diffusely through a surface",
    .grade = Grade::kBounded,
    .judge = judge,
    .provoke = provoke};

}  // namespace raykiln::render
