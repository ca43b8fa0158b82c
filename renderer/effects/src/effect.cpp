#include "raykiln/effects/effect.hpp"

#include "raykiln/effects/effect_row.hpp"

namespace raykiln::render {

std::string_view name(Effect effect) { return row_of(effect).name; }

std::optional<Effect> effect_named(std::string_view name) {
  for (const EffectRow* row : effect_table()) {
    if (name == row->name) return row->effect;
  }
  return std::nullopt;
}

}  // namespace raykiln::render
