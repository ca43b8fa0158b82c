// The environment map of a sidecar: read from the upload, refused by name.
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "raykiln/image/encode.hpp"
#include "raykiln/scene/environment_map.hpp"
#include "support/io/import_text.hpp"

namespace raykiln::render::test {
namespace {

using Code = ImportErrorCode;
using Warn = ImportWarningCode;

const std::string kObj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
const std::string kSidecar = R"({"environment": {"file": "sky/a.exr"}})";

std::string text_of(const Bytes& bytes) { return {bytes.begin(), bytes.end()}; }

std::string exr(int width, int height, const std::vector<float>& rgb) {
  const Image image{.width = width, .height = height, .rgb = rgb};
  return text_of(std::get<Bytes>(encode_exr(image, {})));
}

/// A Radiance picture without run lengths: mantissas and exponent as given.
std::string hdr(int width, int height, const std::string& texels) {
  return "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y " + std::to_string(height) + " +X " +
         std::to_string(width) + "\n" + texels;
}

TEST(Environment, AnExrIsReadWithScaleAndRotation) {
  const auto imported = expect_scene(
      {{"a.obj", kObj}, {"sky/a.exr", exr(2, 1, {1, 2, 3, 0, 0.5F, 0.25F})},
       {"raykiln.json", R"({"environment": {"file": "sky/a.exr", "rotation_degrees": 90, "scale": 2}})"}});
  ASSERT_NE(imported.scene.environment, nullptr);
  const EnvironmentMap& map = *imported.scene.environment;
  EXPECT_EQ(map.name, "sky/a.exr");
  EXPECT_EQ(map.width, 2);
  EXPECT_EQ(map.height, 1);
  EXPECT_EQ(map.rgb, (std::vector<float>{2, 4, 6, 0, 1, 0.5F}));
  EXPECT_DOUBLE_EQ(map.rotation_rad, 0.5 * std::numbers::pi);
  EXPECT_EQ(imported.scene.background, Rgb(0.0F));
  EXPECT_TRUE(imported.scene.point_lights.empty());
  EXPECT_EQ(count_of(imported, Warn::kDefaultBackground), 0U);
}

TEST(Environment, ARadianceFileIsToldByItsBytes) {
  const std::string two("\x80\x40\x20\x82\x80\x80\x80\x80", 8);  // 2, 1, 0.5 and three times 0.5
  const auto imported = expect_scene(
      {{"a.obj", kObj}, {"sky/a.exr", hdr(2, 1, two)}, {"raykiln.json", kSidecar}});
  ASSERT_NE(imported.scene.environment, nullptr);
  const std::vector<float> expected{2, 1, 0.5F, 0.5F, 0.5F, 0.5F};
  ASSERT_EQ(imported.scene.environment->rgb.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {  // readers differ by half a step of the mantissa
    EXPECT_NEAR(imported.scene.environment->rgb[i], expected[i], expected[i] / 60.0F);
  }
}

TEST(Environment, NegativeValuesAreClampedAndListed) {
  const auto imported = expect_scene(
      {{"a.obj", kObj}, {"sky/a.exr", exr(1, 1, {-1, 2, -0.5F})}, {"raykiln.json", kSidecar}});
  EXPECT_EQ(imported.scene.environment->rgb, (std::vector<float>{0, 2, 0}));
  EXPECT_EQ(count_of(imported, Warn::kClampedValue), 2U);
}

TEST(Environment, ABlackOneIsNoLight) {
  const auto imported = expect_scene(
      {{"a.obj", kObj}, {"sky/a.exr", exr(1, 1, {0, 0, 0})}, {"raykiln.json", kSidecar}});
  EXPECT_EQ(count_of(imported, Warn::kNoLight), 1U);
  EXPECT_EQ(imported.scene.background, Rgb(0.0F));
}

TEST(Environment, WhatCannotBeUsedIsRefusedByName) {
  const auto refused = [](const std::string& bytes, ImportOptions options = {}) {
    return expect_error(
        {{"a.obj", kObj}, {"sky/a.exr", bytes}, {"raykiln.json", kSidecar}}, options);
  };
  const ImportError missing = expect_error({{"a.obj", kObj}, {"raykiln.json", kSidecar}});
  EXPECT_EQ(missing.code, Code::kFileMissing);
  EXPECT_NE(missing.message.find("'sky/a.exr'"), std::string::npos) << missing.message;
  EXPECT_EQ(missing.where, "/environment/file");

  const ImportError text = refused("hello");
  EXPECT_EQ(text.code, Code::kInvalidPicture);
  EXPECT_EQ(text.file, "sky/a.exr");

  const std::string good = exr(2, 1, {1, 2, 3, 4, 5, 6});
  EXPECT_EQ(refused(good.substr(0, good.size() / 2)).code, Code::kInvalidPicture);

  const Image image{.width = 1, .height = 1, .rgb = {1, 1, 1}};
  const ImportError png = refused(text_of(std::get<Bytes>(encode_png(image, 0.0))));
  EXPECT_EQ(png.code, Code::kInvalidPicture);
  EXPECT_NE(png.message.find("png"), std::string::npos) << png.message;

  const float infinity = std::numeric_limits<float>::infinity();
  EXPECT_EQ(refused(exr(1, 1, {1, infinity, 1})).code, Code::kNotFinite);
  EXPECT_EQ(refused(exr(1, 1, {std::nanf(""), 1, 1})).code, Code::kNotFinite);

  ImportOptions small;
  small.limits.max_environment_texels = 3;
  const ImportError large = refused(exr(2, 2, std::vector<float>(12, 1.0F)), small);
  EXPECT_EQ(large.code, Code::kInvalidPicture);
  EXPECT_NE(large.message.find("2 x 2"), std::string::npos) << large.message;
  small.limits.max_environment_texels = 4;
  small.limits.max_picture_file_bytes = 10;
  EXPECT_EQ(refused(exr(2, 2, std::vector<float>(12, 1.0F)), small).code, Code::kFileTooLarge);
}

// A header may claim any size: it costs nothing.
TEST(Environment, AClaimedSizeIsRefusedBeforeItIsAllocated) {
  const ImportError error = expect_error(
      {{"a.obj", kObj}, {"sky/a.exr", hdr(1 << 20, 1 << 10, "")}, {"raykiln.json", kSidecar}});
  EXPECT_EQ(error.code, Code::kInvalidPicture);
}

}  // namespace
}  // namespace raykiln::render::test
