#include "rows.hpp"
#include "sources.hpp"

namespace raykiln::render {
namespace {

Judgement judge(const EffectView& view) {
  const Material* m = find_material(view, has_facets);
  return of_surface(view, m, m != nullptr ? says(*m, "roughness", m->facets.roughness) : "",
                    "no material in use has microfacets");
}

void provoke(const EffectExample& at) {
  Material& m = at.scene.materials[at.material];
  m.model = SurfaceModel::kMicrofacet;
  m.diffuse = {0.3F, 0.2F, 0.1F};
  m.specular = {0.5F, 0.4F, 0.3F};
  m.transparent = 0.0F;
  m.facets.roughness = 0.4;
}

}  // namespace

const EffectRow kMicrofacetLobesRow{
    .effect = Effect::kMicrofacetLobes,
    .name = "microfacet_lobes",
    .left_out = "light that GGX facets reflect, and the tables of its energy",
    .grade = Grade::kBounded,
    .judge = judge,
    .provoke = provoke};

}  // namespace raykiln::render
