// What a job says about effects.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "raykiln/effects/effect.hpp"

namespace raykiln::render {

struct EffectChoice {
  enum class Mode : std::uint8_t {
    kAuto,  ///< what the scene calls for, less `without`
    kAll,   ///< the general code for everything, called for or not: what kAuto is checked against
  };
  Mode mode = Mode::kAuto;
  /// Left out although the scene may call for it. Only with kAuto.
  EffectSet without{};

  friend bool operator==(const EffectChoice&, const EffectChoice&) = default;
};

/// "auto", "all", or "without=refraction,roulette" in the order of the table; the inverse accepts
/// any order and gives nothing for other text.
[[nodiscard]] std::string effect_choice_text(const EffectChoice& choice);
[[nodiscard]] std::optional<EffectChoice> effect_choice_of(std::string_view text);

}  // namespace raykiln::render
