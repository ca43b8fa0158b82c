#include <gtest/gtest.h>

#include "raykiln/effects/effect_choice.hpp"
#include "raykiln/effects/effect_row.hpp"

namespace raykiln::render {
namespace {

TEST(EffectTable, HasTheRowOfEachEffectAtItsPlace) {
#define NAME_OF(code_name, name) #name,
  const std::vector<std::string> names{RAYKILN_EFFECTS(NAME_OF)};
#undef NAME_OF
  ASSERT_EQ(effect_table().size(), kEffects);
  for (std::size_t i = 0; i < kEffects; ++i) {
    const auto effect = static_cast<Effect>(i);
    EXPECT_EQ(effect_table()[i]->effect, effect);
    EXPECT_EQ(effect_table()[i]->name, names.at(i));
    EXPECT_EQ(effect_named(name(effect)), effect);
    EXPECT_FALSE(std::string_view(effect_table()[i]->left_out).empty());
  }
  EXPECT_EQ(effect_named("moire"), std::nullopt);
}

TEST(EffectTable, LeavingOutByNameChangesSomething) {
  for (const EffectRow* row : effect_table()) EXPECT_NE(row->grade, Grade::kIdentical) << row->name;
}

TEST(EffectChoice, TextGoesThereAndBack) {
  for (const char* text : {"auto", "all", "without=refraction", "without=refraction,roulette"}) {
    const auto choice = effect_choice_of(text);
    ASSERT_TRUE(choice.has_value()) << text;
    EXPECT_EQ(effect_choice_text(*choice), text);
  }
  EXPECT_EQ(effect_choice_of("without=roulette,refraction"),
            effect_choice_of("without=refraction,roulette"));
}

TEST(EffectChoice, RefusesOtherText) {
  for (const char* text : {"", "none", "without=", "without=moire", "without=roulette,", "Auto"}) {
    EXPECT_EQ(effect_choice_of(text), std::nullopt) << text;
  }
}

TEST(EffectSet, CountsInAndOut) {
  EffectSet set{Effect::kRoulette, Effect::kFresnel};
  EXPECT_TRUE(set.contains(Effect::kFresnel));
  EXPECT_FALSE(set.contains(Effect::kMirrors));
  EXPECT_TRUE((set - EffectSet{Effect::kFresnel}) == EffectSet{Effect::kRoulette});
  EXPECT_TRUE((EffectSet::everything() - EffectSet::everything()).empty());
  EXPECT_TRUE(EffectSet::everything().contains(Effect::kRoulette));
}

}  // namespace
}  // namespace raykiln::render
