#include "raykiln/study/variants.hpp"

#include <functional>

namespace raykiln::render {
namespace {

using Turn = std::function<void(Variant&)>;

/// A knob turned: its name, what that means, and what it needs in a scene to matter.
struct Knob {
  std::string name, what;
  EffectSet needs;  ///< one of these must be called for; empty: always listed
  Turn turn;
};

void fixed_depth(Variant& v, int depth) {
  v.settings.light_model.roulette = false;
  v.settings.max_depth = depth;
}

Turn depth(int reflections) {
  return [reflections](Variant& v) { fixed_depth(v, reflections); };
}

constexpr EffectSet kBounces{Effect::kIndirectLight};
constexpr EffectSet kEmitters{Effect::kEmitterSampling};
constexpr EffectSet kGlass{Effect::kFresnel};
constexpr EffectSet kLobes{Effect::kGlossyLobes, Effect::kMirrors};
constexpr EffectSet kSurfaces{Effect::kWatertightTriangles};

std::vector<Knob> knobs() {
  return {
      {"sampler=sobol", "scrambled Sobol' points in 4 replicates instead of independent numbers", {},
       [](Variant& v) { v.settings.sampler = Sampler::kSobol; }},
      {"depth=2", "paths end after 2 reflections instead of by roulette", kBounces, depth(2)},
      {"depth=4", "paths end after 4 reflections", kBounces, depth(4)},
      {"depth=8", "paths end after 8 reflections", kBounces, depth(8)},
      {"emitters=bsdf", "emitters are found by the path's own rays alone", kEmitters,
       [](Variant& v) { v.settings.emitter_sampling = false; }},
      {"directions=uniform", "directions are uniform over the sphere, as a reference estimator", {},
       [](Variant& v) { v.settings.direction_sampling = DirectionSampling::kUniformSphere; }},
      {"diffuse=uniform", "diffuse directions uniform over the hemisphere, as the seed has them", {},
       [](Variant& v) { v.settings.light_model.diffuse_sampling = DiffuseSampling::kUniform; }},
      {"fresnel=schlick", "Schlick's formula instead of Fresnel's equations", kGlass,
       [](Variant& v) { v.settings.light_model.fresnel = FresnelFormula::kSchlick; }},
      {"phong=over_cos_o", "Phong lobe over the cosine of view, as the seed has it", kLobes,
       [](Variant& v) { v.settings.light_model.phong = PhongCosine::kOverCosO; }},
      {"radiance_scaling=false", "refraction without the change of radiance, as the seed has it", kGlass,
       [](Variant& v) { v.settings.light_model.radiance_scaling = false; }},
      {"pixels=centre", "one ray through the middle of each pixel: no area", {},
       [](Variant& v) { v.settings.pixel_mode = PixelMode::kCentre; }},
      {"textures=footprint", "textures are read as means over what a pixel covers", {Effect::kTextures},
       [](Variant& v) { v.settings.texture_reading = TextureReading::kFootprint; }},
      {"effects=all", "code for every effect, called for or not", {},
       [](Variant& v) { v.settings.effects.mode = EffectChoice::Mode::kAll; }},
      {"triangles=fast", "triangles are tested in float, without a bound on its errors", kSurfaces,
       [](Variant& v) { v.settings.effects.without.insert(Effect::kWatertightTriangles); }},
      {"tree=finer", "a test costs as much as a step of the tree: smaller leaves, more memory", {},
       [](Variant& v) { v.tree.k_i = 1.0; }},
      {"depth=4 emitters=bsdf", "both", kBounces,
       [](Variant& v) { fixed_depth(v, 4), v.settings.emitter_sampling = false; }},
      {"depth=4 fresnel=schlick", "both", kGlass,
       [](Variant& v) { fixed_depth(v, 4), v.settings.light_model.fresnel = FresnelFormula::kSchlick; }},
      {"light_model=seed", "the seed's formulas as a whole, 8 reflections", {},
       [](Variant& v) {
         v.settings.light_model = kSeedModel;
         v.settings.max_depth.reset();
       }},
  };
}

/// How people who know nothing better would render: unbiased throughout.
Variant defaults(const RenderSettings& view) {
  RenderSettings settings;
  settings.width = view.width;
  settings.height = view.height;
  settings.camera = view.camera;
  settings.own_camera = view.own_camera;
  settings.seed = view.seed;
  return {"defaults", "physical model, roulette, emitters by multiple importance sampling", settings, {}};
}

}  // namespace

std::vector<Variant> knob_variants(const RenderSettings& view, const Scene& scene) {
  const Variant plain = defaults(view);
  const EffectSet called_for = effect_plan(plain.settings, scene).called_for;
  std::vector<Variant> variants{plain};
  for (const Knob& knob : knobs()) {
    if (!knob.needs.empty() && !called_for.contains_any(knob.needs)) continue;
    Variant turned = plain;
    turned.name = knob.name;
    turned.what = knob.what;
    knob.turn(turned);
    variants.push_back(std::move(turned));
  }
  return variants;
}

}  // namespace raykiln::render
