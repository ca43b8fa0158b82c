#include <algorithm>

#include "rows.hpp"
#include "sources.hpp"

namespace raykiln::render {
namespace {

Judgement judge(const EffectView& view) {
  if (!has_light(view)) return {false, "there is no light in the scene"};
  if (reflecting_material(view) == nullptr) return {false, "no surface reflects"};
  if (!reaches_two_surfaces(view))
    return {false, "max_depth " + std::to_string(view.job.max_depth) + " ends paths before"};
  return {true, "reflecting surfaces, max_depth " + std::to_string(view.job.max_depth)};
}

void provoke(const EffectExample& at) { at.job.max_depth = std::max(at.job.max_depth, 4); }

}  // namespace

const EffectRow kIndirectLightRow{.effect = Effect::kIndirectLight,
                                  .name = "indirect_light",
                                  .left_out =
                                      "rays that go on from hits, unless emitters or the "
                                      "background may be found by the first of them",
                                  .grade = Grade::kBounded,
                                  .judge = judge,
                                  .provoke = provoke};

}  // namespace raykiln::render
