#include "rows.hpp"
#include "sources.hpp"

namespace raykiln::render {
namespace {

Judgement judge(const EffectView& view) {
  const Material* m = find_material(
      view, [](const Material& c) { return has_facets(c) && c.facets.coverage < 1.0F; });
  return of_surface(
      view, m,
      m != nullptr ? says(*m, "coverage", static_cast<double>(m->facets.coverage)) : "",
      "all materials in use cover their surfaces");
}

void provoke(const EffectExample& at) {
  row_of(Effect::kMicrofacetLobes).provoke(at);
  at.scene.materials[at.material].facets.coverage = 0.3F;
}

}  // namespace

const EffectRow kAlphaCoverageRow{.effect = Effect::kAlphaCoverage,
                                  .name = "alpha_coverage",
                                  .left_out = "light that passes straight through a surface's gaps",
                                  .grade = Grade::kUnbounded,
                                  .judge = judge,
                                  .provoke = provoke};

}  // namespace raykiln::render
