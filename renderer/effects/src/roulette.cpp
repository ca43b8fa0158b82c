#include <algorithm>

#include "rows.hpp"
#include "sources.hpp"

namespace raykiln::render {
namespace {

Judgement judge(const EffectView& view) {
  if (!view.job.light_model.roulette) return {false, "the light model has no roulette"};
  if (!has_light(view)) return {false, "there is no light in the scene"};
  if (reflecting_material(view) == nullptr) return {false, "no surface reflects"};
  if (view.job.max_depth <= kBouncesBeforeRoulette) {
    return {false, "max_depth " + std::to_string(view.job.max_depth) +
                       " ends paths before the first draw"};
  }
  return {true, "paths of up to " + std::to_string(view.job.max_depth) + " reflections"};
}

void provoke(const EffectExample& at) {
  at.job.light_model.roulette = true;
  at.job.max_depth = std::max(at.job.max_depth, 6);
}

}  // namespace

const EffectRow kRouletteRow{.effect = Effect::kRoulette,
                             .name = "roulette",
                             .left_out = "ending paths at random",
                             .grade = Grade::kUnbiased,
                             .judge = judge,
                             .provoke = provoke};

}  // namespace raykiln::render
