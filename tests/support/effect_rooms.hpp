// Random scenes in which each effect is called for or not, drawn with the examples of the table of
// effects: a new row takes part without an edit here.
#pragma once

#include <random>
#include <string>

#include "raykiln/effects/effect_plan.hpp"
#include "support/effect_scenes.hpp"

namespace raykiln::render::support {

/// Where the object of row `i` stands: on a grid over the floor, in view; from the 17th on under the
/// ceiling.
inline Vec3f place_of(std::size_t i) {
  const auto column = static_cast<float>(i % 4), row = static_cast<float>(i / 4 % 4);
  const float up = i < 16 ? 0.0F : 1.2F;
  return {-0.9F + 0.48F * column, -0.9F + 0.1F * row + up, -0.8F + 0.42F * row};
}

/// A matte room, open towards the camera, with a box for every effect of `wanted`, whose material
/// is the effect's example. Light comes in from a grey sky.
inline EffectScene effect_room(EffectSet wanted) {
  EffectScene s{"room", matte_room(), {}};
  Scene& scene = s.builder.scene();
  scene.background = Rgb(0.4F, 0.5F, 0.6F);
  s.settings.max_depth = 1;
  s.settings.width = 20;
  s.settings.height = 16;
  for (std::size_t i = 0; i < kEffects; ++i) {
    const EffectRow& row = *effect_table()[i];
    if (!wanted.contains(row.effect)) continue;
    const auto material = s.builder.material({});
    const Vec3f at = place_of(i);
    s.builder.box(at, at + Vec3f(0.36F, 0.4F, 0.36F), material);
    if (!scene.mesh.corner_normals.empty()) {
      scene.mesh.corner_normals.resize(scene.mesh.triangles.size(),
                                       {kNoNormal, kNoNormal, kNoNormal});
    }
    EffectJob job{.light_model = s.settings.light_model,
                  .max_depth = *s.settings.max_depth,
                  .emitter_sampling = s.settings.emitter_sampling};
    row.provoke({scene, job, material});
    s.settings.light_model = job.light_model;
    s.settings.max_depth = job.max_depth;
    s.settings.emitter_sampling = job.emitter_sampling;
  }
  return s;
}

/// Things that are in many files and call for nothing.
inline void add_clutter(SceneBuilder& b) {
  b.point_light({0.3F, 0.2F, 0.1F}, Rgb(0.0F));
  Material unused = glass_material(1.7F, 20.0);
  unused.emission = Rgb(9.0F);
  b.material(unused);
  Material weightless = diffuse_material(Rgb(0.0F));
  weightless.transparent = 1.0F;
  b.box({0.7F, 0.4F, -0.3F}, {0.8F, 0.5F, -0.2F}, b.material(weightless));
  TriangleMesh& mesh = b.scene().mesh;
  if (!mesh.corner_normals.empty()) {
    mesh.corner_normals.resize(mesh.triangles.size(), {kNoNormal, kNoNormal, kNoNormal});
  }
}

/// Every effect on or off by a coin; model, sky and other settings by dice.
inline EffectScene random_effect_room(std::uint64_t seed) {
  std::mt19937_64 dice(seed);
  const auto coin = [&dice] { return (dice() >> 32 & 1U) != 0; };
  EffectSet wanted;
  for (const EffectRow* row : effect_table()) {
    if (coin()) wanted.insert(row->effect);
  }
  EffectScene s = effect_room(wanted);
  s.name = "random room " + std::to_string(seed);
  if (coin()) add_clutter(s.builder);
  if (!wanted.contains(Effect::kBackground)) s.builder.scene().background = Rgb(0.0F);
  if (coin()) s.settings.max_depth = static_cast<int>(dice() % 7);
  if (coin()) {
    const bool roulette = s.settings.light_model.roulette;
    s.settings.light_model = kSeedModel;
    s.settings.light_model.roulette = roulette;
  }
  if (dice() % 4 == 0) s.settings.pixel_mode = PixelMode::kCentre;
  if (dice() % 8 == 0) s.settings.direction_sampling = DirectionSampling::kUniformSphere;
  if (dice() % 8 == 0) {
    s.settings.branches = 2;
    s.settings.max_depth = std::min(*s.settings.max_depth, 3);
  }
  if (dice() % 4 == 0) s.settings.sampler = Sampler::kSobol;
  s.settings.seed = seed;
  return s;
}

}  // namespace raykiln::render::support
