// The rows, each defined in the file of its name.
#pragma once

#include "raykiln/effects/effect_row.hpp"

namespace raykiln::render {

extern const EffectRow kPointLightsRow;
extern const EffectRow kPointLightShadowsRow;
extern const EffectRow kAreaEmittersRow;
extern const EffectRow kEmitterSamplingRow;
extern const EffectRow kBackgroundRow;
extern const EffectRow kDiffuseReflectionRow;
extern const EffectRow kDiffuseTransmissionRow;
extern const EffectRow kGlossyLobesRow;
extern const EffectRow kMirrorsRow;
extern const EffectRow kRefractionRow;
extern const EffectRow kFresnelRow;
extern const EffectRow kShadingNormalsRow;
extern const EffectRow kIndirectLightRow;
extern const EffectRow kCausticsRow;
extern const EffectRow kRouletteRow;

}  // namespace raykiln::render
