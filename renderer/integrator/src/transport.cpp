#include "transport.hpp"

#include <algorithm>

#include "raykiln/accel/kernels.hpp"
#include "raykiln/integrator/make_ready.hpp"

namespace raykiln::render {
namespace {

constexpr EffectSet kSources{Effect::kPointLights,       Effect::kSpotLights,
                             Effect::kDirectionalLights, Effect::kAreaEmitters,
                             Effect::kBackground,        Effect::kEnvironment};

/// What the instances from kPhong on have no code for.
constexpr EffectSet kRich{Effect::kTextures, Effect::kMicrofacetLobes};

/// Effects that are no more than a value in the settings or the data.
constexpr EffectSet kFolded{
    Effect::kPointLights,     Effect::kSpotLights,  Effect::kDirectionalLights,
    Effect::kEmitterSampling, Effect::kBackground,  Effect::kEnvironment,
    Effect::kFresnel,         Effect::kShadingNormals, Effect::kRoulette,
    Effect::kTextures,        Effect::kDepthOfField, Effect::kAlphaCoverage,
    Effect::kOneSidedSurfaces, Effect::kWatertightTriangles};

PathSettings folded(PathSettings s, const Emitters& emitters) {
  const EffectSet simulated = s.simulated;
  s.emitter_sampling = s.emitter_sampling && emitters.has_triangles() &&
                       simulated.contains(Effect::kAreaEmitters) &&
                       simulated.contains(Effect::kEmitterSampling);
  s.bsdf.light.roulette = s.bsdf.light.roulette && simulated.contains(Effect::kRoulette) &&
                          s.max_depth > kBouncesBeforeRoulette;
  if (!simulated.contains(Effect::kFresnel)) s.bsdf.light.fresnel = FresnelFormula::kNone;
  if (s.left_out.contains(Effect::kWatertightTriangles)) {
    s.traversal = with_test(s.traversal, TriangleTest::kFast);
  }
  if (s.left_out.contains(Effect::kIndirectLight)) s.max_depth = std::min(s.max_depth, 1);
  return s;
}

bool reads_copies(const TransportScene& scene, const PathSettings& settings) {
  return scene.scene.textures != nullptr && settings.simulated.contains(Effect::kTextures) &&
         settings.texture_reading == TextureReading::kFootprint && scene.pyramids != nullptr;
}

/// `settings`: folded().
bool draws_by_tree(const TransportScene& scene, const PathSettings& settings) {
  return settings.emitter_sampling && scene.emitters.by_tree(settings.emitter_choice);
}

/// Light of emitters by way of a body takes two reflections. Left out where caustics are; the formulas of the seed
/// and the estimator that others are held against keep their own directions. `settings`: folded().
bool draws_towards_casters(const TransportScene& scene, const PathSettings& settings) {
  return settings.max_depth >= 2 && scene.emitters.has_triangles() &&
         settings.simulated.contains(Effect::kAreaEmitters) && !settings.left_out.contains(Effect::kCaustics) &&
         settings.bsdf.direction_sampling == DirectionSampling::kBsdf &&
         settings.bsdf.light.diffuse_sampling == DiffuseSampling::kCosine;
}

}  // namespace

bool make_ready(const TransportScene& scene, const PathSettings& settings, const std::stop_token& stop) {
  if (reads_copies(scene, settings) && !scene.pyramids->make(stop)) return false;
  return !draws_by_tree(scene, folded(settings, scene.emitters)) || scene.emitters.make_tree(scene.scene, stop);
}

Transport make_transport(const TransportScene& scene, const PathSettings& settings) {
  const EffectSet simulated = settings.simulated;
  const Scene& s = scene.scene;
  Transport t{.scene = s,
              .mesh = s.mesh,
              .tree = scene.tree,
              .emitters = scene.emitters,
              .point_lights = scene.emitters.point_lights(),
              .spot_lights = scene.emitters.spot_lights(),
              .directional_lights = scene.emitters.directional_lights(),
              .background = s.background,
              .environment = scene.emitters.environment(),
              .textures = s.textures.get(),
              .normals = simulated.contains(Effect::kShadingNormals),
              .settings = folded(settings, scene.emitters)};
  if (!simulated.contains(Effect::kPointLights)) t.point_lights = {};
  if (!simulated.contains(Effect::kSpotLights)) t.spot_lights = {};
  if (!simulated.contains(Effect::kDirectionalLights)) t.directional_lights = {};
  if (!simulated.contains(Effect::kBackground)) t.background = Rgb(0.0F);
  if (!simulated.contains(Effect::kEnvironment)) t.environment = nullptr;
  if (!simulated.contains(Effect::kTextures)) t.textures = nullptr;
  if (reads_copies(scene, settings)) {
    scene.pyramids->make();
    t.pyramids = scene.pyramids;
  }
  t.gaps = gaps_of(s);
  t.gaps.open_parts = t.gaps.open_parts && simulated.contains(Effect::kAlphaCoverage);
  t.gaps.back_faces = t.gaps.back_faces && simulated.contains(Effect::kOneSidedSurfaces);
  t.environment_sampling = t.environment != nullptr && settings.emitter_sampling &&
                           simulated.contains(Effect::kEmitterSampling);
  t.emitters_by_tree = draws_by_tree(scene, t.settings);
  if (draws_towards_casters(scene, t.settings)) t.casters = scene.casters;
  t.has_light = simulated.contains_any(kSources) &&
                (t.has_lights_without_surface() || t.background != Rgb(0.0F) ||
                 t.environment != nullptr || scene.emitters.has_triangles());
  return t;
}

Switches switches_for(const Transport& transport) {
  const PathSettings& s = transport.settings;
  if (!(s.left_out - kFolded).empty()) return kReduced;
  if (s.simulated.contains_any(kRich)) return kGeneral;
  const bool transmits =
      s.simulated.contains_any({Effect::kDiffuseTransmission, Effect::kRefraction});
  if (transmits || s.bsdf.direction_sampling != DirectionSampling::kBsdf) return kPhong;
  if (s.simulated.contains_any({Effect::kGlossyLobes, Effect::kMirrors})) return kOpaque;
  if (transport.normals) return kMatte;
  return s.max_depth > 0 ? kFlatMatte : kDirectFlatMatte;
}

}  // namespace raykiln::render
