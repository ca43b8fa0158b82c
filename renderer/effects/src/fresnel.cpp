#include "rows.hpp"
#include "sources.hpp"

namespace raykiln::render {
namespace {

Judgement judge(const EffectView& view) {
  // Fresnel's equations reflect nothing between equal indices; Schlick's formula does.
  const bool schlick = view.job.light_model.fresnel == FresnelFormula::kSchlick;
  const Material* m = find_material(view, [schlick](const Material& c) {
    return has_border(c) &&
           (schlick || c.index_of_refraction != 1.0F);
  });
  return of_surface(
      view, m,
      m != nullptr ? says(*m, "index of refraction", static_cast<double>(m->index_of_refraction))
                   : "",
      "no transparent material in use has an index of refraction other than 1");
}

void provoke(const EffectExample& at) { row_of(Effect::kRefraction).provoke(at); }

}  // namespace

const EffectRow kFresnelRow{
    .effect = Effect::kFresnel,
    .name = "fresnel",
    .left_out = "the share that borders between media reflect below the critical angle",
    .grade = Grade::kUnbounded,
    .judge = judge,
    .provoke = provoke};

}  // namespace raykiln::render
