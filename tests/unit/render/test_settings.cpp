#include <gtest/gtest.h>

#include "support/scene_pieces.hpp"

namespace raykiln::render {
namespace {

TEST(Settings, NameTheFirstThingThatIsWrong) {
  const Scene scene = support::mixed_room().scene();
  EXPECT_EQ(settings_error({}, scene), std::nullopt);
  const auto check = [&](auto change, const std::string& word) {
    RenderSettings settings;
    change(settings);
    const auto error = settings_error(settings, scene);
    ASSERT_TRUE(error.has_value()) << word;
    EXPECT_NE(error->find(word), std::string::npos) << *error;
  };
  check([](auto& s) { s.width = 0; }, "width");
  check([](auto& s) { s.height = kLargestSide + 1; }, "height");
  check([](auto& s) { s.camera = 1; }, "camera 1");
  check([](auto& s) { s.camera = -1; }, "camera -1");
  check([](auto& s) { s.max_depth = -1; }, "max_depth");
  check([](auto& s) { s.max_depth = kLargestDepth + 1; }, "max_depth");
  check([](auto& s) { s.branches = 0; }, "branches");
  check([](auto& s) { s.branches = 65; }, "branches");
  check([](auto& s) { s.branches = 4, s.max_depth = 8; }, "branches 4");
}

TEST(Settings, BranchesThatStayWithinTheBoundAreAllowed) {
  const Scene scene = support::mixed_room().scene();
  RenderSettings settings;
  settings.branches = 4;
  settings.max_depth = 7;  // 21845 rays
  EXPECT_EQ(settings_error(settings, scene), std::nullopt);
  settings.branches = 2;
  settings.max_depth = kLargestDepth;  // 2^4097 overflows double
  EXPECT_TRUE(settings_error(settings, scene).has_value());
}

TEST(Settings, DepthFollowsTheLightModelUnlessGiven) {
  RenderSettings settings;
  EXPECT_EQ(path_limit(settings), kRouletteLimit);
  settings.branches = 2;  // a tree of rays must be bounded
  EXPECT_EQ(path_limit(settings), kFixedDepth);
  settings = {};
  settings.light_model = kSeedModel;
  EXPECT_EQ(path_limit(settings), 8);
  settings.max_depth = 3;
  EXPECT_EQ(path_limit(settings), 3);
}

TEST(Settings, WarningsNameWhatTheModelGetsWrongInThisScene) {
  const auto codes = [](const LightModel& model, const Scene& scene) {
    std::string all;
    for (const auto& warning : light_model_warnings(model, scene)) all += warning.code + ' ';
    return all;
  };
  const Scene room = support::mixed_room().scene();
  EXPECT_EQ(codes(kPhysicalModel, room), "");
  EXPECT_EQ(codes(kSeedModel, room), "heavy_tailed not_conserving_refraction ");
  LightModel model = kSeedModel;
  model.radiance_scaling = true;
  EXPECT_EQ(codes(model, room), "heavy_tailed ");
  model = kPhysicalModel;
  model.radiance_scaling = false;
  EXPECT_EQ(codes(model, room), "not_conserving_refraction ");
  // Neither matters without a surface that shows it: a sharp mirror, glass of index 1, unused ones.
  support::SceneBuilder b;
  b.triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, b.material(support::mirror_material(1.0F, 1e10)));
  b.triangle({0, 0, 1}, {1, 0, 1}, {0, 1, 1}, b.material(support::glass_material(1.0F, 1e10)));
  b.material(support::glass_material(1.5F, 10.0));
  EXPECT_EQ(codes(kSeedModel, b.scene()), "");
}

TEST(Settings, FilmBytes) {
  EXPECT_EQ(film_bytes(1920, 1080), std::uint64_t{1920} * 1080 * Film::bytes_per_pixel());
  EXPECT_EQ(film_bytes(0, 5), 0U);
  EXPECT_EQ(film_bytes(-1, 5), 0U);
  EXPECT_GT(film_bytes(2147483647, 2147483647), std::uint64_t{1} << 62);
}

TEST(Notices, NameATreeWithoutBenefit) {
  // Parallel oblique sheets: no plane separates them.
  for (const int n : {12, 50, 200}) {
    support::SceneBuilder b;
    const auto white = b.material(support::diffuse_material(Rgb(0.5F)));
    for (int i = 0; i < n; ++i) {
      const float s = 1.0F + static_cast<float>(i) * 1e-3F;
      b.triangle({s, 0, 0}, {0, s, 0}, {0, 0, s}, white);
    }
    b.camera({2, 2, 2}, {0, 0, 0}, {0, 1, 0}, 0.7);
    SerialTaskRunner runner;
    const auto tree = build_scene_tree(b.scene(), {}, runner);
    const auto notices = render_notices({}, b.scene(), build_stats(*tree));
    ASSERT_EQ(notices.size(), n < 32 ? 0U : 1U) << n;
    if (n >= 32) {
      EXPECT_EQ(notices[0].code, "tree_no_benefit");
    }
  }
  // A bound on references is worth a word where it stops many splits, the depth cap never.
  BuildStats bounded;
  bounded.leaves = 100'000;
  bounded.splits_over_depth = 50'000;
  bounded.splits_over_budget = 99;
  support::SceneBuilder nothing;
  nothing.camera({2, 2, 2}, {0, 0, 0}, {0, 1, 0}, 0.7);
  const Scene empty = nothing.scene();
  EXPECT_TRUE(render_notices({}, empty, bounded).empty());
  bounded.splits_over_budget = 100;
  const auto told = render_notices({}, empty, bounded);
  ASSERT_EQ(told.size(), 1U);
  EXPECT_EQ(told[0].code, "tree_budget_reached");
  // A room with a sharp mirror and a point light has the other notice; without the light it has none.
  Scene room = support::mixed_room().scene();
  SerialTaskRunner runner;
  const auto tree = build_scene_tree(room, {}, runner);
  const auto notices = render_notices({}, room, build_stats(*tree));
  ASSERT_EQ(notices.size(), 1U);
  EXPECT_EQ(notices[0].code, "unresolved_sharp_highlight");
  room.point_lights.clear();
  EXPECT_TRUE(render_notices({}, room, build_stats(*tree)).empty());
  DirectionalLight sun;
  sun.irradiance = Rgb(1.0F);
  room.directional_lights = {sun};
  EXPECT_EQ(render_notices({}, room, build_stats(*tree)).size(), 1U);
  room.directional_lights.clear();
  SpotLight spot;
  spot.intensity = Rgb(1.0F);
  room.spot_lights = {spot};
  EXPECT_EQ(render_notices({}, room, build_stats(*tree)).size(), 1U);
}

}  // namespace
}  // namespace raykiln::render
