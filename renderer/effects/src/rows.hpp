// The rows, each defined in the file of its name.
#pragma once

#include "raykiln/effects/effect_row.hpp"

namespace raykiln::render {

#define RAYKILN_EFFECT_ROW(code_name, name) extern const EffectRow k##code_name##Row;
RAYKILN_EFFECTS(RAYKILN_EFFECT_ROW)
#undef RAYKILN_EFFECT_ROW

}  // namespace raykiln::render
