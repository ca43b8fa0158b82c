#include "leave_out.hpp"

#include "raykiln/effects/effect_row.hpp"

namespace raykiln::render {
namespace {

void leave_out_diffuse(Bsdf& b, EffectSet effects) {
  if (effects.contains(Effect::kDiffuseReflection)) {
    b.diffuse_same = Rgbd(0.0);
    b.choice.diffuse_through = 1.0;
  }
  if (effects.contains(Effect::kDiffuseTransmission)) {
    b.diffuse_through = Rgbd(0.0);
    b.choice.diffuse_through = 0.0;
  }
}

void leave_out_specular(Bsdf& b, const Material& material, EffectSet effects, bool all) {
  const bool sharp = material.specular_exp >= kMirrorExponent;
  const bool gloss = !sharp && effects.contains(Effect::kGlossyLobes);
  if (all || gloss || (sharp && effects.contains(Effect::kMirrors))) b.specular_opaque = Rgbd(0.0);
  if (all || gloss) b.specular_transparent = Rgbd(0.0);
  if (effects.contains(Effect::kRefraction)) b.choice.specular_through = 0.0;
}

}  // namespace

void leave_out(Bsdf& b, const Material& material, EffectSet effects, bool all_specular) {
  leave_out_diffuse(b, effects);
  leave_out_specular(b, material, effects, all_specular);
  const Rgbd zero(0.0);
  const bool has_diffuse = b.diffuse_same != zero || b.diffuse_through != zero;
  const bool has_specular = b.specular_opaque != zero || b.specular_transparent != zero;
  const Rgb none(0.0F);
  const auto share = specular_share(has_diffuse ? material.diffuse : none,
                                    has_specular ? material.specular : none);
  b.black = !share;
  b.choice.specular = share.value_or(0.0);
}

void leave_out(MicrofacetBsdf& b, EffectSet effects, bool all_specular) {
  leave_out(b, FacetsLeftOut{
                   .diffuse = effects.contains(Effect::kDiffuseReflection),
                   .diffuse_through = effects.contains(Effect::kDiffuseTransmission),
                   .reflection = all_specular || effects.contains(Effect::kMicrofacetLobes),
                   .transmission = all_specular || effects.contains(Effect::kRefraction)});
}

}  // namespace raykiln::render
