// Which effects a job simulates, and why: a pure function of scene and settings.
#pragma once

#include <string>
#include <vector>

#include "raykiln/effects/effect_choice.hpp"
#include "raykiln/effects/effect_row.hpp"

namespace raykiln::render {

struct EffectVerdict {
  Effect effect = Effect::kCount;
  bool called_for = false;
  bool simulated = false;
  std::string evidence;
  /// Left out by name although called for: the picture is another one, see EffectRow::forced.
  [[nodiscard]] bool approximated() const { return called_for && !simulated; }
};

struct EffectPlan {
  EffectChoice choice;
  std::vector<EffectVerdict> verdicts;  ///< one a row of the table, in its order
  EffectSet called_for, simulated;

  [[nodiscard]] EffectSet approximated() const { return called_for - simulated; }
};

/// Equal arguments give equal plans. `use` is use_of(scene).
[[nodiscard]] EffectPlan plan_effects(const Scene& scene, const SceneUse& use, const EffectJob& job,
                                      const EffectChoice& choice);

/// "auto", "all", "without=refraction (bounded)": marks a picture; grades only where it was called
/// for.
[[nodiscard]] std::string effects_label(const EffectPlan& plan);

}  // namespace raykiln::render
