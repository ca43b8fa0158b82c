#include <gtest/gtest.h>

#include "raykiln/effects/effect_plan.hpp"
#include "support/effect_scenes.hpp"

namespace raykiln::render {
namespace {

EffectPlan plan(support::EffectScene s, const char* choice) {
  const Scene& scene = s.builder.scene();
  return plan_effects(scene, use_of(scene), {.max_depth = path_limit(s.settings), .lens_radius = scene.cameras[0].lens.radius},
                      effect_choice_of(choice).value());
}

TEST(EffectPlan, AutoSimulatesWhatIsCalledFor) {
  const EffectPlan matte = plan(support::matte_point_light(), "auto");
  EXPECT_TRUE(matte.called_for == (EffectSet{Effect::kPointLights, Effect::kPointLightShadows,
                                             Effect::kDiffuseReflection, Effect::kWatertightTriangles}));
  EXPECT_TRUE(matte.simulated == matte.called_for);
  EXPECT_TRUE(matte.approximated().empty());
  EXPECT_TRUE(plan(support::complete(), "auto").simulated == EffectSet::everything());
}

TEST(EffectPlan, AllSimulatesEverything) {
  const EffectPlan all = plan(support::matte_point_light(), "all");
  EXPECT_TRUE(all.simulated == EffectSet::everything());
  EXPECT_TRUE(all.approximated().empty());
  EXPECT_EQ(effects_label(all), "all");
}

TEST(EffectPlan, WhatIsLeftOutByNameIsMarked) {
  const EffectPlan draft = plan(support::everything(), "without=refraction,roulette");
  EXPECT_TRUE(draft.approximated() == (EffectSet{Effect::kRefraction, Effect::kRoulette}));
  EXPECT_EQ(effects_label(draft),
            "without=refraction,roulette (refraction bounded, roulette unbiased)");
}

TEST(EffectPlan, LeavingOutWhatIsNotCalledForIsNoApproximation) {
  const EffectPlan same = plan(support::diffuse_cornell(), "without=refraction");
  EXPECT_TRUE(same.approximated().empty());
  EXPECT_EQ(effects_label(same), "without=refraction");
}

TEST(EffectPlan, WhatOnlyServesAnotherGoesWithIt) {
  const EffectPlan dark = plan(support::everything(), "without=area_emitters,point_lights");
  EXPECT_FALSE(dark.simulated.contains(Effect::kEmitterSampling));
  EXPECT_FALSE(dark.simulated.contains(Effect::kPointLightShadows));
}

TEST(EffectPlan, HasAReasonForEveryRow) {
  for (const support::EffectScene& scene : support::named_effect_scenes()) {
    const EffectPlan p = plan(scene, "auto");
    for (const EffectRow* row : effect_table()) {
      EXPECT_FALSE(p.evidence[static_cast<std::size_t>(row->effect)].empty()) << row->name;
    }
    EXPECT_TRUE(p.called_for == p.simulated);
  }
}

TEST(EffectPlan, GradesWhatIsLeftOut) {
  const EffectPlan cornell = plan(support::diffuse_cornell(), "without=roulette");
  EXPECT_EQ(cornell.grade(Effect::kDiffuseReflection), std::nullopt);
  EXPECT_EQ(cornell.grade(Effect::kRefraction), Grade::kIdentical);
  EXPECT_EQ(cornell.grade(Effect::kRoulette), Grade::kUnbiased);
  EXPECT_EQ(plan(support::diffuse_cornell(), "all").grade(Effect::kRefraction), std::nullopt);
}

}  // namespace
}  // namespace raykiln::render
