// The effects that can be simulated or left out, by name, and sets of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string_view>

#include "raykiln/effects/effect_list.hpp"

namespace raykiln::render {

/// One value a row of effect_list.hpp, in its order.
enum class Effect : std::uint8_t {
#define RAYKILN_EFFECT_VALUE(code_name, name) k##code_name,
  RAYKILN_EFFECTS(RAYKILN_EFFECT_VALUE)
#undef RAYKILN_EFFECT_VALUE
      kCount
};
inline constexpr std::size_t kEffects = static_cast<std::size_t>(Effect::kCount);

class EffectSet {
 public:
  constexpr EffectSet() = default;
  constexpr EffectSet(std::initializer_list<Effect> effects) {
    for (const Effect effect : effects) insert(effect);
  }
  [[nodiscard]] static constexpr EffectSet everything() {
    EffectSet all;
    all.bits_ = (1U << kEffects) - 1U;
    return all;
  }

  [[nodiscard]] constexpr bool contains(Effect effect) const { return (bits_ & bit(effect)) != 0; }
  [[nodiscard]] constexpr bool contains_any(EffectSet other) const {
    return (bits_ & other.bits_) != 0;
  }
  [[nodiscard]] constexpr bool empty() const { return bits_ == 0; }
  constexpr void insert(Effect effect) { bits_ |= bit(effect); }
  constexpr void erase(Effect effect) { bits_ &= ~bit(effect); }

  /// What is in the first and not in the second.
  friend constexpr EffectSet operator-(EffectSet a, EffectSet b) {
    a.bits_ &= ~b.bits_;
    return a;
  }
  friend constexpr EffectSet operator&(EffectSet a, EffectSet b) {
    a.bits_ &= b.bits_;
    return a;
  }
  friend constexpr bool operator==(EffectSet, EffectSet) = default;

 private:
  static constexpr std::uint32_t bit(Effect effect) { return 1U << static_cast<unsigned>(effect); }
  static_assert(kEffects < 32);
  std::uint32_t bits_ = 0;
};

/// "point_lights": the word of the API.
[[nodiscard]] std::string_view name(Effect effect);
[[nodiscard]] std::optional<Effect> effect_named(std::string_view name);

}  // namespace raykiln::render
