// Which effects a job simulates, and why: a pure function of scene and settings.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "raykiln/effects/effect_choice.hpp"
#include "raykiln/effects/effect_row.hpp"

namespace raykiln::render {

struct EffectPlan {
  EffectChoice choice;
  EffectSet called_for, simulated;
  /// At the index of an effect: the material, light or setting that decides whether it is called for.
  std::array<std::string, kEffects> evidence;

  /// Left out by name although called for: the picture is another one.
  [[nodiscard]] EffectSet approximated() const { return called_for - simulated; }
  /// What leaving the effect out does to this picture; nothing where it is simulated.
  [[nodiscard]] std::optional<Grade> grade(Effect effect) const;
};

/// Equal arguments give equal plans. `use` is use_of(scene).
[[nodiscard]] EffectPlan plan_effects(const Scene& scene, const SceneUse& use, const EffectJob& job,
                                      const EffectChoice& choice);

/// "auto", "all", "without=refraction (refraction bounded)": marks a picture; grades only where it
/// was called for.
[[nodiscard]] std::string effects_label(const EffectPlan& plan);

}  // namespace raykiln::render
