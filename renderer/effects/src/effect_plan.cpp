#include "raykiln/effects/effect_plan.hpp"

namespace raykiln::render {
namespace {

/// An effect that only serves another goes with it.
EffectSet what_is_left(EffectSet called_for, EffectSet without) {
  EffectSet left = called_for - without;
  if (!left.contains(Effect::kPointLights)) left.erase(Effect::kPointLightShadows);
  if (!left.contains(Effect::kAreaEmitters)) left.erase(Effect::kEmitterSampling);
  return left;
}

}  // namespace

EffectPlan plan_effects(const Scene& scene, const SceneUse& use, const EffectJob& job,
                        const EffectChoice& choice) {
  const EffectView view{scene, use, job};
  EffectPlan plan;
  plan.choice = choice;
  for (const EffectRow* row : effect_table()) {
    Judgement judgement = row->judge(view);
    if (judgement.called_for) plan.called_for.insert(row->effect);
    plan.verdicts.push_back({.effect = row->effect,
                             .called_for = judgement.called_for,
                             .evidence = std::move(judgement.evidence)});
  }
  plan.simulated = choice.mode == EffectChoice::Mode::kAll
                       ? EffectSet::everything()
                       : what_is_left(plan.called_for, choice.without);
  for (EffectVerdict& verdict : plan.verdicts) {
    // What no row vouches for bit by bit stays, unless it is named.
    const EffectRow& row = row_of(verdict.effect);
    if (row.grade != Grade::kIdentical && !choice.without.contains(row.effect)) {
      plan.simulated.insert(row.effect);
    }
    verdict.simulated = plan.simulated.contains(verdict.effect);
  }
  return plan;
}

std::string effects_label(const EffectPlan& plan) {
  std::string label = effect_choice_text(plan.choice);
  std::string grades;
  for (const EffectVerdict& verdict : plan.verdicts) {
    if (!verdict.approximated()) continue;
    grades += grades.empty() ? "" : ", ";
    grades +=
        std::string(name(verdict.effect)) + ' ' + std::string(name(row_of(verdict.effect).forced));
  }
  return grades.empty() ? label : label + " (" + grades + ')';
}

}  // namespace raykiln::render
