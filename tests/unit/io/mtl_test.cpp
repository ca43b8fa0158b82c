// MTL files and their mapping.
#include <string>

#include "material_mapping.hpp"
#include "support/io/import_text.hpp"

namespace raykiln::render::test {
namespace {

using Code = ImportErrorCode;
using Warn = ImportWarningCode;

const std::string kObj = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n";

Material first_material(const std::string& mtl) {
  const auto imported = expect_scene({{"a.obj", kObj}, {"m.mtl", mtl}});
  if (imported.scene.materials.empty()) return {};
  expect_sound(imported);
  return imported.scene.materials[imported.scene.mesh.material_ids[0]];
}

TEST(Mtl, DiffuseAndSpecular) {
  const Material m = first_material("newmtl a\nKd 0.5 0.25 0.125\nKs 0.25\nNs 100\nillum 2\n");
  EXPECT_EQ(m.name, "a");
  EXPECT_EQ(m.diffuse, Rgb(0.5F, 0.25F, 0.125F));
  EXPECT_EQ(m.specular, Rgb(0.25F));
  EXPECT_EQ(m.specular_exp, 100.0);
  EXPECT_EQ(m.transparent, 0.0F);
}

TEST(Mtl, Illum1HasNoHighlight) {
  EXPECT_EQ(first_material("newmtl a\nKd 0.5 0.5 0.5\nKs 1 1 1\nillum 1\n").specular, Rgb(0.0F));
}

TEST(Mtl, EmissionIsRadiance) {
  EXPECT_EQ(first_material("newmtl a\nKe 10 20 30\n").emission, Rgb(10.0F, 20.0F, 30.0F));
}

TEST(Mtl, GlassByIllumination) {
  const Material m = first_material("newmtl a\nKd 0.5 0.5 0.5\nKs 1 1 1\nNi 1.33\nillum 7\n");
  EXPECT_EQ(m.transparent, 1.0F);
  EXPECT_EQ(m.diffuse, Rgb(0.0F));
  EXPECT_EQ(m.specular, Rgb(1.0F));
  EXPECT_FLOAT_EQ(m.index_of_refraction, 1.33F);
  EXPECT_GE(m.specular_exp, io::kPolishedExponent);
}

TEST(Mtl, OpacityLetsLightThrough) {
  const Material m = first_material("newmtl a\nKd 0.8 0.8 0.8\nd 0.25\n");
  EXPECT_FLOAT_EQ(m.transparent, 0.75F);
  EXPECT_FLOAT_EQ(m.diffuse.x, 0.2F);
  EXPECT_FLOAT_EQ(m.specular.x, 0.75F);
  EXPECT_EQ(m.index_of_refraction, 1.0F);
}

TEST(Mtl, TrIsOneMinusDAndDWins) {
  EXPECT_FLOAT_EQ(first_material("newmtl a\nTr 0.75\n").transparent, 0.75F);
  EXPECT_FLOAT_EQ(first_material("newmtl a\nd 1\nTr 1\n").transparent, 0.0F);
  EXPECT_FLOAT_EQ(first_material("newmtl a\nTr 1\nd 1\n").transparent, 0.0F);
}

TEST(Mtl, TheFirstDefinitionStays) {
  EXPECT_EQ(first_material("newmtl a\nKd 1 0 0\nnewmtl a\nKd 0 1 0\n").diffuse,
            Rgb(1.0F, 0.0F, 0.0F));
}

TEST(Mtl, TexturesAreListed) {
  const auto imported = expect_scene(
      {{"a.obj", kObj}, {"m.mtl", "newmtl a\nKd 0.5 0.5 0.5\nmap_Ks x.png\nbump y.png\n"}});
  EXPECT_EQ(count_of(imported, Warn::kIgnoredTexture), 2U);
}

TEST(Mtl, ReflectingTooMuchIsListed) {
  const auto imported =
      expect_scene({{"a.obj", kObj}, {"m.mtl", "newmtl a\nKd 0.8 0.8 0.8\nKs 0.5 0.5 0.5\n"}});
  EXPECT_EQ(count_of(imported, Warn::kNotConserving), 1U);
}

TEST(Mtl, AMissingFileIsAWarningAndTheMaterialIsGrey) {
  const auto imported = expect_scene({{"a.obj", kObj}});
  EXPECT_EQ(count_of(imported, Warn::kMissingMaterialFile), 1U);
  EXPECT_EQ(count_of(imported, Warn::kUnknownMaterial), 1U);
  EXPECT_EQ(imported.scene.materials[0].diffuse, Rgb(0.8F));
}

TEST(Mtl, IsFoundBesideTheObjWhateverTheCase) {
  const std::string obj = "mtllib .\\Sub\\My Lib.MTL\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n";
  const auto imported =
      expect_scene({{"dir/a.obj", obj}, {"dir/sub/my lib.mtl", "newmtl a\nKd 1 0 0\n"}});
  EXPECT_EQ(imported.scene.materials[0].diffuse, Rgb(1.0F, 0.0F, 0.0F));
}

TEST(Mtl, NamesThatLeaveTheUploadFindNothing) {
  for (const char* path : {"../m.mtl", "/etc/passwd", "a/../../m.mtl", "C:\\m.mtl"}) {
    const std::string obj = std::string("mtllib ") + path + "\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    const auto imported = expect_scene({{"a.obj", obj}, {"m.mtl", "newmtl a\n"}});
    EXPECT_EQ(count_of(imported, Warn::kMissingMaterialFile), 1U) << path;
  }
}

struct Row {
  const char* name;
  const char* mtl;
  Code code;
  const char* where;
};

class MtlRefuses : public testing::TestWithParam<Row> {};

TEST_P(MtlRefuses, WithItsPlace) {
  const ImportError error = expect_error({{"a.obj", kObj}, {"m.mtl", GetParam().mtl}});
  EXPECT_EQ(name(error.code), name(GetParam().code)) << error.message;
  EXPECT_EQ(error.file, "m.mtl");
  EXPECT_EQ(error.where, GetParam().where);
}

INSTANTIATE_TEST_SUITE_P(
    All, MtlRefuses,
    testing::Values(Row{"before_newmtl", "Kd 1 1 1\n", Code::kSyntax, "line 1"},
                    Row{"no_name", "newmtl\n", Code::kSyntax, "line 1"},
                    Row{"two_components", "newmtl a\nKd 1 1\n", Code::kSyntax, "line 2"},
                    Row{"text", "newmtl a\nKd red\n", Code::kSyntax, "line 2"},
                    Row{"nothing", "newmtl a\nNs\n", Code::kSyntax, "line 2"},
                    Row{"nan", "newmtl a\n\nKs nan 0 0\n", Code::kNotFinite, "line 3"},
                    Row{"overflow", "newmtl a\nKe 1e999 0 0\n", Code::kNotFinite, "line 2"}),
    [](const auto& row) { return std::string(row.param.name); });

TEST(Mtl, OutOfRangeValuesAreClampedAndListed) {
  const auto imported = expect_scene(
      {{"a.obj", kObj}, {"m.mtl", "newmtl a\nKd -1 0.5 0.5\nNs 1e20\nNi 0\nd 7\n"}});
  EXPECT_EQ(count_of(imported, Warn::kClampedValue), 4U);
  expect_sound(imported);
}

TEST(Roughness, ExponentFollowsTheFormulaAndIsCapped) {
  EXPECT_EQ(io::exponent_of_roughness(0.0), io::kMaxExponent);
  EXPECT_EQ(io::exponent_of_roughness(1e-5), io::kMaxExponent);
  EXPECT_NEAR(io::exponent_of_roughness(0.5), (2.0 / 0.0625 - 2.0) / 4.0, 1e-12);
  EXPECT_EQ(io::exponent_of_roughness(1.0), 0.0);
}

}  // namespace
}  // namespace raykiln::render::test
