#include "raykiln/effects/effect_plan.hpp"

namespace raykiln::render {
namespace {

/// An effect that only serves another goes with it.
EffectSet what_is_left(EffectSet called_for, EffectSet without) {
  EffectSet left = called_for - without;
  constexpr EffectSet kUnfindable{Effect::kPointLights, Effect::kSpotLights,
                                  Effect::kDirectionalLights};
  constexpr EffectSet kSampled{Effect::kAreaEmitters, Effect::kEnvironment};
  if (!left.contains_any(kUnfindable)) left.erase(Effect::kPointLightShadows);
  if (!left.contains_any(kSampled)) left.erase(Effect::kEmitterSampling);
  return left;
}

}  // namespace

std::optional<Grade> EffectPlan::grade(Effect effect) const {
  if (simulated.contains(effect)) return std::nullopt;
  return called_for.contains(effect) ? row_of(effect).grade : Grade::kIdentical;
}

EffectPlan plan_effects(const Scene& scene, const SceneUse& use, const EffectJob& job,
                        const EffectChoice& choice) {
  const EffectView view{scene, use, job};
  EffectPlan plan;
  plan.choice = choice;
  for (std::size_t i = 0; i < kEffects; ++i) {
    const EffectRow& row = *effect_table()[i];
    Judgement judgement = row.judge(view);
    if (judgement.called_for) plan.called_for.insert(row.effect);
    plan.evidence[i] = std::move(judgement.evidence);
  }
  plan.simulated = choice.mode == EffectChoice::Mode::kAll
                       ? EffectSet::everything()
                       : what_is_left(plan.called_for, choice.without);
  return plan;
}

std::string effects_label(const EffectPlan& plan) {
  std::string grades;
  for (const EffectRow* row : effect_table()) {
    if (!plan.approximated().contains(row->effect)) continue;
    grades += grades.empty() ? "" : ", ";
    grades.append(row->name).append(" ").append(name(row->grade));
  }
  const std::string label = effect_choice_text(plan.choice);
  return grades.empty() ? label : label + " (" + grades + ')';
}

}  // namespace raykiln::render
