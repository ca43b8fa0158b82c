#include <algorithm>

#include "raykiln/shading/coverage.hpp"
#include "rows.hpp"
#include "sources.hpp"

namespace raykiln::render {
namespace {

Judgement judge(const EffectView& view) {
  const auto& used = view.use.materials;
  const auto found =
      std::find_if(used.begin(), used.end(), [&](std::uint32_t id) { return has_open_parts(view.scene, id); });
  if (found == used.end()) return {false, "all materials in use cover their surfaces"};
  const Material& m = view.scene.materials[*found];
  const bool plain = m.coverage < 1.0F;
  return of_surface(view, &m,
                    plain ? says(m, "coverage", static_cast<double>(m.coverage))
                          : named(m) + " has a texture of coverage",
                    "");
}

void provoke(const EffectExample& at) {
  Material& material = at.scene.materials[at.material];
  if (!is_reflecting(material)) material.diffuse = {0.5F, 0.6F, 0.2F};
  material.coverage = 0.3F;
}

}  // namespace

const EffectRow kAlphaCoverageRow{.effect = Effect::kAlphaCoverage,
                                  .name = "alpha_coverage",
                                  .left_out = "asking at hits whether a surface is there, and rays that go on where it is not",
                                  .grade = Grade::kUnbounded,
                                  .judge = judge,
                                  .provoke = provoke};

}  // namespace raykiln::render
