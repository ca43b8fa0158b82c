// Taking lobes out of a BSDF that has them.
#pragma once

#include "raykiln/effects/effect.hpp"
#include "raykiln/shading/bsdf.hpp"
#include "raykiln/shading/microfacet_bsdf.hpp"

namespace raykiln::render {

/// Removes the light of `effects` from the BSDF of `material` and has sampling choose among what is
/// left; with `all_specular` every specular lobe goes. Fresnel's share is the light model's.
void leave_out(Bsdf& bsdf, const Material& material, EffectSet effects, bool all_specular);
/// The same for microfacets. Coverage is the material's.
void leave_out(MicrofacetBsdf& bsdf, EffectSet effects, bool all_specular);

}  // namespace raykiln::render
