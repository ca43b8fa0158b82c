#include <gtest/gtest.h>

#include <algorithm>

#include "raykiln/study/variants.hpp"
#include "support/scene_pieces.hpp"

namespace raykiln::render {
namespace {

std::vector<std::string> names(const Scene& scene) {
  RenderSettings view;
  view.width = view.height = 8;
  std::vector<std::string> result;
  for (const Variant& v : knob_variants(view, scene)) result.push_back(v.name);
  return result;
}

bool has(const std::vector<std::string>& all, const std::string& name) {
  return std::find(all.begin(), all.end(), name) != all.end();
}

TEST(KnobVariants, OfARoomWithEverythingAllAreThereOnce) {
  auto all = names(support::mixed_room().scene());
  EXPECT_EQ(all.front(), "defaults");
  EXPECT_GE(all.size(), 15U);
  std::sort(all.begin(), all.end());
  EXPECT_EQ(std::adjacent_find(all.begin(), all.end()), all.end());
}

TEST(KnobVariants, WhatCannotChangeAPictureIsNotListed) {
  support::SceneBuilder b;
  b.level_square(1.0F, 0.0F, b.material(support::diffuse_material(Rgb(0.5F))), true);
  b.scene().background = Rgb(1.0F);
  b.look({0, 0, 3}, {0, 0, 0}, {0, 1, 0}, 0.5);
  const auto listed = names(b.scene());
  EXPECT_FALSE(has(listed, "fresnel=schlick") || has(listed, "emitters=bsdf") || has(listed, "phong=over_cos_o"));
  EXPECT_FALSE(has(listed, "textures=footprint"));
  EXPECT_TRUE(has(listed, "diffuse=uniform") && has(listed, "light_model=seed"));
}

TEST(KnobVariants, TheViewIsKeptAndApproximationsAreNot) {
  RenderSettings view;
  view.width = 12;
  view.height = 7;
  view.seed = 9;
  view.light_model = kSeedModel;
  view.effects.without = {Effect::kRefraction};
  const auto room = support::mixed_room();
  const Variant plain = knob_variants(view, room.scene()).front();
  EXPECT_EQ(plain.settings.width, 12);
  EXPECT_EQ(plain.settings.height, 7);
  EXPECT_EQ(plain.settings.seed, 9U);
  EXPECT_EQ(plain.settings.light_model, kPhysicalModel);
  EXPECT_TRUE(plain.settings.effects.without.empty());
}

}  // namespace
}  // namespace raykiln::render
