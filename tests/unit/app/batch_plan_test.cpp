#include "batch/batch_plan.hpp"

#include <gtest/gtest.h>

#include <sstream>

namespace raykiln::server {
namespace {

Result<BatchPlan> planned(const std::string& text) {
  const auto value = parse_yaml(text);
  if (!value) return value.error();
  return plan_batch(*value, "/scenes", JobLimits{});
}

TEST(BatchPlan, IsScenesTimesCamerasTimesSettings) {
  const auto plan = planned(R"(
name: nightly
false_alarms: 0.02
defaults: {width: 64, height: 48, seed: 3}
reference: refs/{scene}/{name}.exr
scenes:
  - scene: box.obj
    cameras: [front, 1]
    settings:
      - {name: fast, stop: {samples: 4}}
      - {name: deep, max_depth: 5}
  - {scene: "sub/a b.glb", name: glass}
)");
  ASSERT_TRUE(plan) << plan.error().message << plan.error().where;
  EXPECT_EQ(plan->name, "nightly");
  ASSERT_EQ(plan->pictures.size(), 5U);
  const PlannedPicture& deep = plan->pictures[3];
  EXPECT_EQ(deep.name, "box-1-deep");
  EXPECT_EQ(deep.scene, "/scenes/box.obj");
  EXPECT_EQ(deep.reference, "/scenes/refs/box/box-1-deep.exr");
  EXPECT_EQ(std::get<int>(deep.request.camera), 1);
  EXPECT_EQ(*deep.request.max_depth, 5);
  EXPECT_EQ(deep.request.stop.samples, 64U);
  EXPECT_EQ(deep.request.width, 64);
  EXPECT_EQ(std::get<std::string>(plan->pictures[0].request.camera), "front");
  EXPECT_EQ(plan->pictures[0].request.stop.samples, 4U);
  EXPECT_EQ(plan->pictures[4].name, "glass");
  EXPECT_DOUBLE_EQ(plan->comparison.noise.false_alarms, 0.02 / 5.0);
}

TEST(BatchPlan, JsonIsRead) {
  const auto plan = planned(R"({"scenes": [{"scene": "a\u0062.obj", "cameras": [{"name": "mine", "eye": [0, 0, 5], "look_at": [0, 0, 0]}]}]})");
  ASSERT_TRUE(plan) << plan.error().message;
  EXPECT_EQ(plan->pictures[0].name, "ab-mine");
  EXPECT_TRUE(plan->pictures[0].reference.empty());
  EXPECT_DOUBLE_EQ(std::get<OwnCamera>(plan->pictures[0].request.camera).eye[2], 5.0);
}

TEST(BatchPlan, NamesFitForFiles) {
  const auto plan = planned("scenes: [{scene: '../../etc/.x y', name: '../ä'}]");
  ASSERT_TRUE(plan);
  EXPECT_EQ(plan->pictures[0].name.find_first_of("/ \\"), std::string::npos);
  EXPECT_NE(plan->pictures[0].name.front(), '.');
}

TEST(BatchPlan, WhatIsWrongIsNamedWithItsLine) {
  const std::vector<std::pair<const char*, const char*>> rows = {
      {"name: x", "scenes is missing"},
      {"scenes: []", "must be a list"},
      {"scenes:\n  - {scene: a.obj}\n  - {scene: b/a.obj}", "two pictures are named"},
      {"scenes: [{scene: a.obj, colour: red}]", "no field \"colour\""},
      {"scenes: [{scene: a.obj, settings: [{widht: 3}]}]", "/widht"},
      {"scenes: [{scene: a.obj, settings: [{width: 0}]}]", "/width"},
      {"scenes: [{scene: a.obj, settings: [{scene: b}]}]", "no setting of a picture"},
      {"max_active: 0\nscenes: [{scene: a.obj}]", "max_active"},
      {"fail_fast: maybe\nscenes: [{scene: a.obj}]", "fail_fast"},
      {"[1, 2]", "map of fields"},
      {"a: 1\na: 2", "twice"},
      {"a: [", ""}};
  for (const auto& [text, part] : rows) {
    const auto plan = planned(text);
    ASSERT_FALSE(plan) << text;
    EXPECT_NE(plan.error().message.find(part), std::string::npos) << text << ": " << plan.error().message;
  }
  EXPECT_EQ(planned("scenes:\n  - {scene: a.obj, colour: red}").error().where, "line 2");
}

TEST(Yaml, AliasesCannotGrowWithoutBound) {
  std::ostringstream text;
  text << "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n";
  for (int i = 1; i < 9; ++i) {
    text << 'a' << i << ": &a" << i << " [*a" << i - 1;
    for (int k = 0; k < 9; ++k) text << ", *a" << i - 1;
    text << "]\n";
  }
  EXPECT_FALSE(parse_yaml(text.str()));
}

TEST(Yaml, ScalarsAreThoseOfJson) {
  const auto value = parse_yaml("[no, 012, 1e3, -0.5, 'true', true, ~, null, .5, '7', \"a\\\"b\"]");
  ASSERT_TRUE(value);
  EXPECT_EQ(to_json(*value), R"(["no","012",1e3,-0.5,"true",true,null,null,".5","7","a\"b"])");
}

TEST(Yaml, HostileDocumentsAreRefusedSoon) {
  const auto repeated = [](const char* piece, std::size_t bytes) {
    std::string text;
    while (text.size() < bytes) text += piece;
    return text;
  };
  EXPECT_FALSE(parse_yaml(std::string(1'000'000, '[')));
  EXPECT_FALSE(parse_yaml(repeated("{a: ", 1'000'000)));
  EXPECT_FALSE(parse_yaml(repeated("- ", 1'000'000)));
  EXPECT_FALSE(parse_yaml(std::string(1, '[').append(1'000'000, ',')));
  EXPECT_FALSE(parse_yaml("a: &a [*a]"));
  std::string keys;  // all different: as many comparisons as their number, not its square
  for (int i = 0; i < 60'000; ++i) keys.append("k").append(std::to_string(i)).append(": 1\n");
  EXPECT_TRUE(parse_yaml(keys));
}

TEST(BatchPlan, WhatIsCopiedIntoEveryPictureIsBounded) {
  const auto refused = [](const std::string& text, const char* part) {
    const auto plan = planned(text);
    ASSERT_FALSE(plan);
    EXPECT_NE(plan.error().message.find(part), std::string::npos) << plan.error().message.substr(0, 200);
  };
  const auto with = [](const char* before, std::size_t letters, const char* after) {
    return std::string(before).append(letters, 'x').append(after).append("\nscenes: [{scene: a.obj}]");
  };
  refused(with("defaults: {name: ", 5000, "}"), "4096");
  refused(with("reference: ", 5000, ""), "4096");
  refused(with("name: ", 201, ""), "at most 200 bytes");
  std::string many = "scenes:\n- scene: a.obj\n  cameras: [";
  for (int i = 0; i < 40; ++i) many.append(std::to_string(i)).append(",");
  many += "]\n  settings: [";
  for (int i = 0; i < 40; ++i) many.append("{name: s").append(std::to_string(i)).append("},");
  refused(many.append("]"), "more than 1000 pictures");
}

TEST(BatchPlan, ALongTextBehindManyAliasesIsRefused) {
  std::string text = "[&a \"" + std::string(500'000, 'x') + '"';
  for (int i = 0; i < 20; ++i) text += ", *a";
  const auto value = parse_yaml(text + "]");
  ASSERT_FALSE(value);
  EXPECT_NE(value.error().message.find("aliases"), std::string::npos);
}

}  // namespace
}  // namespace raykiln::server
