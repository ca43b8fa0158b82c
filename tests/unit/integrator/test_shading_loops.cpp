// Which instance of the shading loop a plan runs.
#include <gtest/gtest.h>

#include <functional>

#include "raykiln/integrator/path_tracer.hpp"
#include "support/effect_scenes.hpp"

namespace raykiln::render {
namespace {

std::string loop_of(support::EffectScene s, const char* choice) {
  s.settings.effects = effect_choice_of(choice).value();
  const Scene& scene = s.builder.scene();
  SerialTaskRunner runner;
  const auto tree = build_scene_tree(scene, {}, runner);
  const EffectPlan plan = effect_plan(s.settings, scene);
  PathSettings settings;
  settings.max_depth = path_limit(s.settings);
  settings.bsdf.direction_sampling = s.settings.direction_sampling;
  settings.bsdf.light = s.settings.light_model;
  settings.simulated = plan.simulated;
  settings.left_out = plan.approximated();
  const Emitters emitters(scene);
  const CameraRays camera(scene.cameras[0], 8, 8, bounds(*tree));
  return std::string(PathTracer({scene, *tree, emitters}, camera, settings).shading_loop());
}

support::EffectScene cornell_with(const Material& material) {
  support::EffectScene s = support::diffuse_cornell();
  s.builder.box({0.3F, -0.4F, 0.0F}, {0.5F, -0.2F, 0.2F}, s.builder.material(material));
  return s;
}

support::EffectScene cornell_with_ball() {
  support::EffectScene s = support::diffuse_cornell();
  support::add_ball(s.builder, {0, 0, 0}, 0.2F, 6,
                    s.builder.material(support::diffuse_material(Rgb(0.5F))), true);
  return s;
}

TEST(ShadingLoops, TheLeanestThatHoldsWhatIsSimulatedRuns) {
  EXPECT_EQ(loop_of(support::matte_point_light(), "auto"), "direct_flat_matte");
  EXPECT_EQ(loop_of(support::diffuse_cornell(), "auto"), "flat_matte");
  EXPECT_EQ(loop_of(cornell_with_ball(), "auto"), "matte");
  EXPECT_EQ(loop_of(cornell_with(support::mirror_material(0.9F, 1e10)), "auto"), "opaque");
  EXPECT_EQ(loop_of(cornell_with(support::mirror_material(0.9F, 20.0)), "auto"), "opaque");
  EXPECT_EQ(loop_of(cornell_with(support::glass_material(1.5F, 1e10)), "auto"), "phong");
  EXPECT_EQ(loop_of(support::everything(), "auto"), "phong");
}

TEST(ShadingLoops, WhatTheSeedHasNotNeedsTheGeneralOne) {
  Material metal;
  metal.model = SurfaceModel::kMicrofacet;
  metal.specular = Rgb(0.8F);
  EXPECT_EQ(loop_of(cornell_with(metal), "auto"), "general");
  EXPECT_EQ(loop_of(cornell_with(metal), "without=microfacet_lobes"), "reduced");
}

TEST(ShadingLoops, AllIsTheGeneralOne) {
  for (const support::EffectScene& scene : support::named_effect_scenes()) {
    EXPECT_EQ(loop_of(scene, "all"), "general") << scene.name;
  }
}

TEST(ShadingLoops, UniformDirectionsNeedBothSides) {
  support::EffectScene s = support::diffuse_cornell();
  s.settings.direction_sampling = DirectionSampling::kUniformSphere;
  EXPECT_EQ(loop_of(s, "auto"), "phong");
}

TEST(ShadingLoops, OnlyWhatIsAskedAtEveryVertexNeedsTheReducedOne) {
  EXPECT_EQ(loop_of(support::everything(), "without=refraction"), "reduced");
  EXPECT_EQ(loop_of(support::everything(), "without=roulette,fresnel"), "phong");
  EXPECT_EQ(loop_of(support::diffuse_cornell(), "without=refraction"), "flat_matte");
  EXPECT_EQ(loop_of(cornell_with_ball(), "without=shading_normals"), "flat_matte");
}

}  // namespace
}  // namespace raykiln::render
