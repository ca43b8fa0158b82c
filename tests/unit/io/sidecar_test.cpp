// raykiln.json: one table for the reader and for the schema (see check_schema.py).
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>

#include "support/io/import_text.hpp"

namespace raykiln::render::test {
namespace {

using Code = ImportErrorCode;
using Warn = ImportWarningCode;

const std::string kObj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

TEST(Sidecar, AcceptsAndRefusesWhatTheTableSays) {
  std::ifstream file(RAYKILN_SIDECARS);
  const auto rows = nlohmann::json::parse(file);
  ASSERT_GT(rows.size(), 20U);
  for (const auto& row : rows) {
    const std::string name = row["name"];
    const Texts files{{"a.obj", kObj}, {"raykiln.json", row["document"].dump()}};
    const ImportResult result = import_texts(files);
    const auto* error = std::get_if<ImportError>(&result);
    if (row["valid"].get<bool>()) {
      EXPECT_EQ(error, nullptr) << name << ": " << (error != nullptr ? error->message : "");
      continue;
    }
    ASSERT_NE(error, nullptr) << name;
    EXPECT_EQ(render::name(error->code), row["code"].get<std::string>()) << name;
    EXPECT_EQ(error->where, row["where"].get<std::string>()) << name;
    EXPECT_EQ(error->file, "raykiln.json") << name;
  }
}

TEST(Sidecar, SetsCamerasLightsBackgroundAndMaterials) {
  const auto imported = expect_scene({{"a.obj", kObj}, {"raykiln.json", R"({
      "camera": {"eye": [0, 0, 5], "look_at": [0, 0, 0], "fov_deg": 90},
      "point_lights": [{"position": [1, 2, 3], "intensity": [4, 5, 6]}],
      "background": [0.5, 0.25, 0],
      "materials": {"default": {"diffuse": [0.1, 0.2, 0.3], "specular_exp": 1e6}}})"}});
  const Scene& scene = imported.scene;
  ASSERT_EQ(scene.cameras.size(), 1U);
  EXPECT_EQ(scene.cameras[0].eye, Vec3d(0, 0, 5));
  EXPECT_EQ(scene.cameras[0].forward, Vec3d(0, 0, -1));
  EXPECT_EQ(scene.cameras[0].right, Vec3d(1, 0, 0));
  EXPECT_DOUBLE_EQ(scene.cameras[0].fov_y_rad, 0.5 * std::numbers::pi);
  ASSERT_EQ(scene.point_lights.size(), 1U);
  EXPECT_EQ(scene.point_lights[0].position, Vec3f(1, 2, 3));
  EXPECT_EQ(scene.point_lights[0].intensity, Rgb(4, 5, 6));
  EXPECT_EQ(scene.background, Rgb(0.5F, 0.25F, 0.0F));
  EXPECT_EQ(scene.materials[0].diffuse, Rgb(0.1F, 0.2F, 0.3F));
  EXPECT_EQ(scene.materials[0].specular_exp, 1e6);
  EXPECT_TRUE(imported.report.warnings.empty());
}

TEST(Sidecar, CamerasMayHaveALensOrBeOrthographic) {
  const auto imported = expect_scene({{"a.obj", kObj}, {"raykiln.json", R"({"scale": 0.5, "cameras": [
      {"eye": [0, 0, 4], "look_at": [0, 0, 0], "lens_radius": 0.5},
      {"eye": [0, 0, 4], "look_at": [0, 0, 0], "lens_radius": 0.5, "focus_distance": 3},
      {"name": "plan", "eye": [0, 0, 4], "look_at": [0, 0, 0], "view_height": 10}]})"}});
  const auto& cameras = imported.scene.cameras;
  ASSERT_EQ(cameras.size(), 3U);
  EXPECT_EQ(cameras[0].lens.radius, 0.25);
  EXPECT_EQ(cameras[0].lens.focus_distance, 2.0) << "what it looks at is sharp";
  EXPECT_EQ(cameras[1].lens.focus_distance, 1.5);
  EXPECT_EQ(cameras[2].projection, Projection::kOrthographic);
  EXPECT_EQ(cameras[2].view_height, 5.0);
  EXPECT_EQ(cameras[2].lens.radius, 0.0);
}

TEST(Sidecar, ScaleAppliesToEveryPosition) {
  const auto imported = expect_scene({{"a.obj", kObj}, {"raykiln.json", R"({"scale": 0.5,
      "camera": {"eye": [0, 0, 4], "look_at": [0, 0, 0]},
      "point_lights": [{"position": [2, 0, 0], "intensity": [1, 1, 1]}]})"}});
  EXPECT_EQ(imported.scene.bounds.hi, Vec3f(0.5F, 0.5F, 0.0F));
  EXPECT_EQ(imported.scene.cameras[0].eye, Vec3d(0, 0, 2));
  EXPECT_EQ(imported.scene.point_lights[0].position, Vec3f(1, 0, 0));
}

TEST(Sidecar, SpotsAndSuns) {
  const auto imported = expect_scene({{"a.obj", kObj}, {"raykiln.json", R"({"scale": 0.5,
      "point_lights": [{"position": [0, 0, 0], "intensity": [1, 1, 1], "range": 8}],
      "spot_lights": [{"position": [2, 0, 0], "direction": [0, -3, 0], "intensity": [1, 2, 3],
                       "inner_deg": 10, "outer_deg": 20, "range": 6}],
      "directional_lights": [{"direction": [0, 0, -2], "irradiance": [4, 5, 6]}]})"}});
  const Scene& scene = imported.scene;
  ASSERT_EQ(scene.point_lights.size(), 1U);
  EXPECT_EQ(scene.point_lights[0].range, 4.0F);
  ASSERT_EQ(scene.spot_lights.size(), 1U);
  const SpotLight& spot = scene.spot_lights[0];
  EXPECT_EQ(spot.position, Vec3f(1, 0, 0));
  EXPECT_EQ(spot.axis, Vec3d(0, -1, 0));
  EXPECT_EQ(spot.intensity, Rgb(1, 2, 3));
  EXPECT_EQ(spot.range, 3.0F);
  const double degree = std::numbers::pi / 180.0;
  EXPECT_NEAR(spot.inner_one_minus_cos, 1.0 - std::cos(10.0 * degree), 1e-15);
  EXPECT_NEAR(spot.outer_one_minus_cos, 1.0 - std::cos(20.0 * degree), 1e-15);
  ASSERT_EQ(scene.directional_lights.size(), 1U);
  EXPECT_EQ(scene.directional_lights[0].direction, Vec3d(0, 0, -1));
  EXPECT_EQ(scene.directional_lights[0].irradiance, Rgb(4, 5, 6));
  EXPECT_EQ(scene.background, Rgb(0.0F));
  EXPECT_EQ(count_of(imported, Warn::kDefaultBackground), 0U);
}

TEST(Sidecar, UnknownMaterialNamesAreListed) {
  const auto imported =
      expect_scene({{"a.obj", kObj}, {"raykiln.json", R"({"materials": {"x": {}}})"}});
  EXPECT_EQ(count_of(imported, Warn::kUnknownMaterial), 1U);
}

TEST(Sidecar, LightsWithoutPowerAreDropped) {
  const auto imported = expect_scene({{"a.obj", kObj}, {"raykiln.json", R"({"point_lights": [
      {"position": [0, 0, 0], "intensity": [0, 0, 0]},
      {"position": [0, 0, 0], "intensity": [0, 1e-30, 0]}]})"}});
  EXPECT_EQ(imported.scene.point_lights.size(), 1U);
  EXPECT_EQ(count_of(imported, Warn::kZeroLight), 1U);
}

TEST(Sidecar, LiesBesideTheSceneInAFolder) {
  const auto imported = expect_scene(
      {{"dir/a.obj", kObj}, {"dir/raykiln.json", R"({"scene": "a.obj", "background": [1, 1, 1]})"}});
  EXPECT_EQ(imported.report.root_file, "dir/a.obj");
  EXPECT_EQ(imported.scene.background, Rgb(1.0F));
}

struct Broken {
  const char* name;
  std::string text;
  Code code;
  const char* where;
};

class SidecarRefuses : public testing::TestWithParam<Broken> {};

TEST_P(SidecarRefuses, WithItsPlace) {
  const ImportError error =
      expect_error({{"a.obj", kObj}, {"raykiln.json", GetParam().text}});
  EXPECT_EQ(name(error.code), name(GetParam().code)) << error.message;
  EXPECT_EQ(error.where, GetParam().where);
}

INSTANTIATE_TEST_SUITE_P(
    All, SidecarRefuses,
    testing::Values(
        Broken{"empty", "", Code::kInvalidJson, "line 1"},
        Broken{"truncated", "{\n\"scale\": 1,\n", Code::kInvalidJson, "line 3"},
        Broken{"comment", "{} // no", Code::kInvalidJson, "line 1"},
        Broken{"nan", "{\"scale\": NaN}", Code::kInvalidJson, "line 1"},
        Broken{"overflow", "{\n\"scale\": 1e999}", Code::kNotFinite, "line 2"},
        Broken{"not_utf8", "{\"scene\": \"\xFF\"}", Code::kInvalidJson, "line 1"},
        Broken{"deep", "\n" + std::string(100'000, '['), Code::kJsonTooDeep, "line 2"},
        Broken{"deep_objects", [] {
          std::string text;
          for (int i = 0; i < 100'000; ++i) text += "{\"a\":";
          return text;
        }(), Code::kJsonTooDeep, "line 1"}),
    [](const auto& row) { return std::string(row.param.name); });

TEST(Sidecar, TooManyValuesAreRefusedBeforeTheParse) {
  ImportOptions options;
  options.limits.max_json_values = 1000;
  std::string text = "[0";
  for (int i = 0; i < 2000; ++i) text += ",0";
  EXPECT_EQ(expect_error({{"a.obj", kObj}, {"raykiln.json", text + "]"}}, options).code,
            Code::kLimitExceeded);
}

}  // namespace
}  // namespace raykiln::render::test
