// What the glTF and GLB readers accept.
#include <algorithm>
#include <cmath>
#include <string>

#include "support/io/gltf_builder.hpp"
#include "support/io/import_text.hpp"

namespace raykiln::render::test {
namespace {

using Json = nlohmann::json;
using Warn = ImportWarningCode;

ImportedScene scene_of(const GltfBuilder& builder) {
  auto imported = expect_scene({{"a.gltf", builder.gltf()}});
  expect_sound(imported);
  return imported;
}

TEST(Gltf, ATriangleFromEachContainer) {
  GltfBuilder builder;
  builder.triangle();
  const auto from_gltf = scene_of(builder);
  const auto from_glb = expect_scene({{"a.glb", builder.glb()}});
  EXPECT_EQ(from_gltf.report.format, SceneFormat::kGltf);
  EXPECT_EQ(from_glb.report.format, SceneFormat::kGlb);
  for (const auto* imported : {&from_gltf, &from_glb}) {
    ASSERT_EQ(imported->scene.mesh.triangles.size(), 1U);
    EXPECT_EQ(area(imported->scene, 0), 0.5);
    EXPECT_EQ(normal_of(imported->scene, 0), Vec3d(0, 0, 1));
  }
}

TEST(Gltf, BuffersBesideTheFileWithEscapedNames) {
  GltfBuilder builder;
  builder.triangle();
  builder.root["buffers"] =
      Json::array({{{"byteLength", builder.bin.size()}, {"uri", "sub/my%20data.bin"}}});
  const auto imported =
      expect_scene({{"d/a.gltf", builder.gltf()}, {"d/sub/my data.bin", builder.bin + "more"}});
  EXPECT_EQ(imported.scene.mesh.triangles.size(), 1U);
}

// Strip and fan of the same square, and the modes without surface.
TEST(Gltf, PrimitiveModes) {
  const std::vector<float> strip{0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};
  const std::vector<float> fan{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  for (const int mode : {5, 6}) {
    GltfBuilder builder;
    builder.primitive({{"attributes", {{"POSITION", builder.vec3(mode == 5 ? strip : fan)}}}, {"mode", mode}});
    const auto imported = scene_of(builder);
    ASSERT_EQ(imported.scene.mesh.triangles.size(), 2U);
    EXPECT_EQ(total_area(imported.scene), 1.0);
    EXPECT_EQ(normal_of(imported.scene, 0), Vec3d(0, 0, 1)) << mode;
    EXPECT_EQ(normal_of(imported.scene, 1), Vec3d(0, 0, 1)) << mode;
  }
  GltfBuilder builder;
  builder.triangle();
  for (const int mode : {0, 1, 2, 3}) {
    builder.primitive({{"attributes", {{"POSITION", builder.vec3(fan)}}}, {"mode", mode}});
  }
  EXPECT_EQ(count_of(scene_of(builder), Warn::kIgnoredElement), 4U);
}

TEST(Gltf, IndexTypes) {
  const std::vector<float> square{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  for (const int type : {5121, 5123, 5125}) {
    GltfBuilder builder;
    const int view = type == 5121   ? builder.view<std::uint8_t>({0, 1, 2, 0, 2, 3})
                     : type == 5123 ? builder.view<std::uint16_t>({0, 1, 2, 0, 2, 3})
                                    : builder.view<std::uint32_t>({0, 1, 2, 0, 2, 3});
    builder.primitive({{"attributes", {{"POSITION", builder.vec3(square)}}},
                       {"indices", builder.accessor(view, type, 6, "SCALAR")}});
    EXPECT_EQ(total_area(scene_of(builder).scene), 1.0) << type;
  }
}

TEST(Gltf, StridedAndQuantizedPositions) {
  GltfBuilder builder;
  const int view = builder.view<std::int16_t>({0, 0, 0, 99, 32767, 0, 0, 99, 0, 32767, 0, 99}, 8);
  const int accessor = builder.accessor(view, 5122, 3, "VEC3");
  builder.root["accessors"][accessor]["normalized"] = true;
  builder.root["extensionsRequired"] = {"KHR_mesh_quantization"};
  builder.primitive({{"attributes", {{"POSITION", accessor}}}});
  EXPECT_EQ(total_area(scene_of(builder).scene), 0.5);
}

TEST(Gltf, SparseAccessorsReplaceElements) {
  GltfBuilder builder;
  const int accessor = builder.vec3({0, 0, 0, 1, 0, 0, 7, 7, 7});
  const int indices = builder.view<std::uint8_t>({2});
  const int values = builder.view<float>({0, 4, 0});
  builder.root["accessors"][accessor]["sparse"] = {
      {"count", 1},
      {"indices", {{"bufferView", indices}, {"componentType", 5121}}},
      {"values", {{"bufferView", values}}}};
  builder.primitive({{"attributes", {{"POSITION", accessor}}}});
  EXPECT_EQ(total_area(scene_of(builder).scene), 2.0);
}

TEST(Gltf, SparseWithoutABaseStartsAtZero) {
  GltfBuilder builder;
  const int indices = builder.view<std::uint16_t>({1, 2});
  const int values = builder.view<float>({1, 0, 0, 0, 1, 0});
  builder.root["accessors"].push_back(
      {{"componentType", 5126}, {"count", 3}, {"type", "VEC3"},
       {"sparse", {{"count", 2},
                   {"indices", {{"bufferView", indices}, {"componentType", 5123}}},
                   {"values", {{"bufferView", values}}}}}});
  builder.primitive({{"attributes", {{"POSITION", 0}}}});
  EXPECT_EQ(total_area(scene_of(builder).scene), 0.5);
}

TEST(Gltf, TransformsApplyFromTheRootDownwards) {
  GltfBuilder builder;
  builder.triangle();
  const double h = std::sqrt(0.5);
  builder.root["nodes"] = Json::array(
      {{{"translation", {10, 0, 0}}, {"rotation", {0, 0, h, h}}, {"children", {1}}},
       {{"matrix", {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 1, 1}}, {"mesh", 0}}});
  const auto imported = scene_of(builder);
  // (1,0,0) -> (2,0,1) -> 90 degrees about z -> (0,2,1) -> (10,2,1)
  const Vec3d p = Vec3d(imported.scene.mesh.positions[1]) + imported.scene.origin;
  EXPECT_NEAR(p.x, 10.0, 1e-6);
  EXPECT_NEAR(p.y, 2.0, 1e-6);
  EXPECT_NEAR(p.z, 1.0, 1e-6);
}

TEST(Gltf, MirroringKeepsTheOutsideOutside) {
  GltfBuilder builder;
  const int normals = builder.vec3({0, 0, 1, 0, 0, 1, 0, 0, 1});
  builder.triangle();
  builder.root["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = normals;
  builder.root["nodes"][0]["scale"] = {-1, 1, 1};
  const auto imported = scene_of(builder);
  EXPECT_EQ(normal_of(imported.scene, 0), Vec3d(0, 0, 1));
  EXPECT_EQ(imported.scene.mesh.normals[0], Vec3f(0, 0, 1));
}

TEST(Gltf, NormalsFollowTheInverseTranspose) {
  GltfBuilder builder;
  const float h = static_cast<float>(std::sqrt(0.5));
  const int normals = builder.vec3({h, h, 0, h, h, 0, h, h, 0});
  builder.primitive({{"attributes", {{"POSITION", builder.vec3({1, 0, 0, 0, 1, 0, 1, 0, 1})}, {"NORMAL", normals}}}});
  builder.root["nodes"][0]["scale"] = {4, 1, 1};
  const auto imported = scene_of(builder);
  const Vec3d expected = normalize(Vec3d(0.25, 1.0, 0.0));
  EXPECT_NEAR(dot(Vec3d(imported.scene.mesh.normals[0]), expected), 1.0, 1e-6);
  EXPECT_NEAR(std::abs(dot(normal_of(imported.scene, 0), expected)), 1.0, 1e-6);
}

TEST(Gltf, OneMeshUsedTwiceIsTwoMeshes) {
  GltfBuilder builder;
  builder.triangle();
  builder.root["nodes"] =
      Json::array({{{"mesh", 0}, {"children", {1}}}, {{"mesh", 0}, {"translation", {0, 0, 1}}}});
  EXPECT_EQ(scene_of(builder).scene.mesh.triangles.size(), 2U);
}

TEST(Gltf, TheDefaultSceneIsChosen) {
  GltfBuilder builder;
  builder.triangle();
  builder.root["nodes"].push_back({{"mesh", 0}, {"scale", {2, 2, 2}}});
  builder.root["scenes"].push_back({{"nodes", {1}}});
  builder.root["scene"] = 1;
  EXPECT_EQ(total_area(scene_of(builder).scene), 2.0);
  builder.root.erase("scene");
  EXPECT_EQ(total_area(scene_of(builder).scene), 0.5);
  builder.root.erase("scenes");
  EXPECT_EQ(total_area(scene_of(builder).scene), 2.5);
}

TEST(Gltf, CamerasLookAlongMinusZ) {
  GltfBuilder builder;
  builder.triangle();
  builder.root["cameras"] = {{{"type", "perspective"}, {"name", "c"}, {"perspective", {{"yfov", 0.8}, {"znear", 0.1}}}},
                             {{"type", "orthographic"}, {"orthographic", {{"xmag", 1}, {"ymag", 2.5}}}},
                             {{"type", "fisheye"}}};
  builder.root["nodes"].push_back({{"camera", 0}, {"translation", {0, 0, 2}}, {"scale", {3, 3, 3}}});
  builder.root["nodes"].push_back({{"camera", 1}});
  builder.root["nodes"].push_back({{"camera", 2}});
  builder.root["scenes"][0]["nodes"] = {0, 1, 2, 3};
  const auto imported = scene_of(builder);
  ASSERT_EQ(imported.scene.cameras.size(), 2U);
  EXPECT_EQ(imported.scene.cameras[0].projection, Projection::kPerspective);
  EXPECT_EQ(imported.scene.cameras[1].projection, Projection::kOrthographic);
  EXPECT_EQ(imported.scene.cameras[1].view_height, 5.0);
  EXPECT_EQ(imported.scene.cameras[1].name, "camera 2");
  EXPECT_EQ(imported.scene.cameras[0].name, "c");
  EXPECT_EQ(imported.scene.cameras[0].eye, Vec3d(0, 0, 2));
  EXPECT_EQ(imported.scene.cameras[0].forward, Vec3d(0, 0, -1));
  EXPECT_EQ(imported.scene.cameras[0].fov_y_rad, 0.8);
  EXPECT_EQ(count_of(imported, Warn::kUnsupportedCamera), 1U);
}

/// A scene with these lights, one a node; every node is at (0, 3, 0), turned so that -z is down and
/// scaled by 2.
ImportedScene lights_scene(const Json& lights) {
  GltfBuilder builder;
  builder.triangle();
  builder.root["extensionsUsed"] = {"KHR_lights_punctual"};
  builder.root["extensions"]["KHR_lights_punctual"]["lights"] = lights;
  const double h = std::sqrt(0.5);
  for (std::size_t light = 0; light < lights.size(); ++light) {
    builder.root["nodes"].push_back(
        {{"translation", {0, 3, 0}}, {"rotation", {-h, 0, 0, h}}, {"scale", {2, 2, 2}}});
    builder.root["nodes"].back()["extensions"]["KHR_lights_punctual"]["light"] = light;
    builder.root["scenes"][0]["nodes"].push_back(builder.root["nodes"].size() - 1);
  }
  return scene_of(builder);
}

TEST(GltfLights, SpotsSunsAndRanges) {
  const auto imported = lights_scene(
      {{{"type", "spot"}, {"intensity", 5}, {"range", 7},
        {"spot", {{"innerConeAngle", 0.25}, {"outerConeAngle", 0.5}}}},
       {{"type", "spot"}},
       {{"type", "directional"}, {"intensity", 3}, {"color", {1, 0.5, 0}}},
       {{"type", "point"}, {"range", 4}}});
  const Scene& scene = imported.scene;
  ASSERT_EQ(scene.spot_lights.size(), 2U);
  EXPECT_EQ(scene.spot_lights[0].position, Vec3f(0, 3, 0));
  EXPECT_EQ(scene.spot_lights[0].intensity, Rgb(5.0F));
  EXPECT_EQ(scene.spot_lights[0].range, 7.0F);  // not scaled by the node
  EXPECT_NEAR(length(scene.spot_lights[0].axis - Vec3d(0, -1, 0)), 0.0, 1e-15);
  EXPECT_NEAR(scene.spot_lights[0].inner_one_minus_cos, 1.0 - std::cos(0.25), 1e-15);
  EXPECT_NEAR(scene.spot_lights[0].outer_one_minus_cos, 1.0 - std::cos(0.5), 1e-15);
  EXPECT_EQ(scene.spot_lights[1].range, kEndlessRange);
  EXPECT_EQ(scene.spot_lights[1].inner_one_minus_cos, 0.0);
  EXPECT_NEAR(scene.spot_lights[1].outer_one_minus_cos, 1.0 - std::sqrt(0.5), 1e-15);
  ASSERT_EQ(scene.directional_lights.size(), 1U);
  EXPECT_EQ(scene.directional_lights[0].irradiance, Rgb(3.0F, 1.5F, 0.0F));
  EXPECT_NEAR(length(scene.directional_lights[0].direction - Vec3d(0, -1, 0)), 0.0, 1e-15);
  ASSERT_EQ(scene.point_lights.size(), 1U);
  EXPECT_EQ(scene.point_lights[0].range, 4.0F);
  EXPECT_EQ(scene.background, Rgb(0.0F));
}

TEST(GltfLights, WhatIsWrongIsRefusedWithItsPlace) {
  const auto error_of = [](const Json& light) {
    GltfBuilder builder;
    builder.triangle();
    builder.root["extensionsUsed"] = {"KHR_lights_punctual"};
    builder.root["extensions"]["KHR_lights_punctual"]["lights"] = Json::array({light});
    builder.root["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0;
    const auto result = import_scene(MemoryFiles({{"a.gltf", builder.gltf()}}));
    const auto* error = std::get_if<ImportError>(&result);
    return error == nullptr ? std::string("accepted")
                            : std::string(name(error->code)) + ' ' + error->where;
  };
  const std::string at = "/extensions/KHR_lights_punctual/lights/0";
  EXPECT_EQ(error_of({{"type", "spot"},
                      {"spot", {{"innerConeAngle", 0.5}, {"outerConeAngle", 0.5}}}}),
            "invalid_value " + at + "/spot");
  EXPECT_EQ(error_of({{"type", "spot"}, {"spot", {{"outerConeAngle", 1.6}}}}),
            "invalid_value " + at + "/spot/outerConeAngle");
  EXPECT_EQ(error_of({{"type", "point"}, {"range", 0}}), "invalid_value " + at + "/range");
  EXPECT_EQ(error_of({{"type", "directional"}, {"intensity", -1}}),
            "invalid_value " + at + "/intensity");
  EXPECT_EQ(error_of({{"type", "spot"}, {"spot", 3}}), "wrong_type " + at + "/spot");
}

TEST(Gltf, PointLightsAreReadUnknownKindsListed) {
  GltfBuilder builder;
  builder.triangle();
  builder.root["extensionsUsed"] = {"KHR_lights_punctual"};
  builder.root["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "point"}, {"color", {1, 0.5, 0}}, {"intensity", 8}}, {{"type", "torch"}}};
  for (const int light : {0, 1}) {
    builder.root["nodes"].push_back({{"translation", {0, 3, 0}}});
    builder.root["nodes"].back()["extensions"]["KHR_lights_punctual"]["light"] = light;
  }
  builder.root["scenes"][0]["nodes"] = {0, 1, 2};
  const auto imported = scene_of(builder);
  ASSERT_EQ(imported.scene.point_lights.size(), 1U);
  EXPECT_EQ(imported.scene.point_lights[0].intensity, Rgb(8, 4, 0));
  EXPECT_EQ(imported.scene.point_lights[0].position, Vec3f(0, 3, 0));
  EXPECT_EQ(count_of(imported, Warn::kUnsupportedLight), 1U);
}

Material material_of(const Json& material) {
  GltfBuilder builder;
  builder.triangle();
  builder.root["materials"] = Json::array({material});
  builder.root["meshes"][0]["primitives"][0]["material"] = 0;
  const auto imported = scene_of(builder);
  return imported.scene.materials.empty() ? Material{} : imported.scene.materials[0];
}

TEST(GltfMaterial, MetalReflectsItsColour) {
  const Material m = material_of({{"pbrMetallicRoughness",
      {{"baseColorFactor", {0.9, 0.6, 0.3, 1}}, {"metallicFactor", 1}, {"roughnessFactor", 0.5}}}});
  EXPECT_EQ(m.model, SurfaceModel::kMicrofacet);
  EXPECT_EQ(m.diffuse, Rgb(0.0F));
  EXPECT_FLOAT_EQ(m.specular.x, 0.9F);
  EXPECT_EQ(m.facets.edge, 1.0F);
  EXPECT_EQ(m.facets.roughness, 0.5);
}

TEST(GltfMaterial, DielectricsReflectFourPercent) {
  const Material m = material_of({{"pbrMetallicRoughness",
      {{"baseColorFactor", {0.5, 0.5, 0.5, 1}}, {"metallicFactor", 0}}}});
  EXPECT_FLOAT_EQ(m.specular.x, 0.04F);
  EXPECT_FLOAT_EQ(m.diffuse.x, 0.5F);
  EXPECT_EQ(m.facets.edge, 1.0F);
  EXPECT_EQ(m.transparent, 0.0F);
}

TEST(GltfMaterial, SpecularScalesBothEnds) {
  const Material m = material_of({{"pbrMetallicRoughness", {{"metallicFactor", 0}}},
      {"extensions", {{"KHR_materials_specular", {{"specularFactor", 0.5}, {"specularColorFactor", {1, 2, 100}}}}}}});
  EXPECT_FLOAT_EQ(m.specular.x, 0.02F);
  EXPECT_FLOAT_EQ(m.specular.y, 0.04F);
  EXPECT_FLOAT_EQ(m.specular.z, 0.5F);
  EXPECT_FLOAT_EQ(m.facets.edge, 0.5F);
}

TEST(GltfMaterial, TransmissionIsASheetAndVolumeABody) {
  Json glass = {{"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 0}, {"baseColorFactor", {1, 0.5, 0, 1}}}},
                {"extensions", {{"KHR_materials_transmission", {{"transmissionFactor", 1}}},
                                {"KHR_materials_ior", {{"ior", 1.33}}}}}};
  const Material sheet = material_of(glass);
  EXPECT_EQ(sheet.transparent, 1.0F);
  EXPECT_TRUE(sheet.facets.thin);
  EXPECT_EQ(sheet.facets.tint, Rgb(1.0F, 0.5F, 0.0F));
  EXPECT_FLOAT_EQ(sheet.index_of_refraction, 1.33F);
  EXPECT_EQ(sheet.facets.roughness, 0.0);
  glass["extensions"]["KHR_materials_volume"] = {
      {"thicknessFactor", 1}, {"attenuationDistance", 2}, {"attenuationColor", {1, 0.5, 0}}};
  const Material body = material_of(glass);
  EXPECT_FALSE(body.facets.thin);
  EXPECT_EQ(body.facets.absorption.x, 0.0F);
  EXPECT_FLOAT_EQ(body.facets.absorption.y, std::log(2.0F) / 2.0F);
  EXPECT_FLOAT_EQ(body.facets.absorption.z, std::log(1e4F) / 2.0F);
}

// A field of the seed's model in the sidecar makes it one of that model, as near as it gets.
TEST(GltfMaterial, TheSidecarTurnsToTheSeedsModel) {
  GltfBuilder builder;
  builder.triangle();
  builder.root["materials"] = Json::array({{{"name", "a"}, {"pbrMetallicRoughness", {{"roughnessFactor", 0.5}}}}});
  builder.root["meshes"][0]["primitives"][0]["material"] = 0;
  const auto with = [&](const char* fields) {
    return expect_scene({{"a.gltf", builder.gltf()},
                         {"raykiln.json", std::string(R"({"materials": {"a": )") + fields + "}}"}})
        .scene.materials[0];
  };
  const Material phong = with(R"({"diffuse": [0.1, 0.1, 0.1]})");
  EXPECT_EQ(phong.model, SurfaceModel::kPhong);
  EXPECT_EQ(phong.diffuse, Rgb(0.1F));
  EXPECT_NEAR(phong.specular_exp, 7.5, 1e-9);
  const Material lamp = with(R"({"emission": [1, 1, 1]})");
  EXPECT_EQ(lamp.model, SurfaceModel::kMicrofacet);
  EXPECT_EQ(lamp.emission, Rgb(1.0F));
}

TEST(GltfMaterial, EmissionHasAStrength) {
  const Material m = material_of(
      {{"emissiveFactor", {1, 0.5, 0}},
       {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 20}}}}}});
  EXPECT_EQ(m.emission, Rgb(20, 10, 0));
}

TEST(GltfMaterial, AlphaCountsOnlyWhenBlended) {
  const Json pbr = {{"baseColorFactor", {1, 1, 1, 0.25}}, {"metallicFactor", 0}};
  EXPECT_EQ(material_of({{"pbrMetallicRoughness", pbr}}).coverage, 1.0F);
  const Json blend = {{"pbrMetallicRoughness", pbr}, {"alphaMode", "BLEND"}};
  EXPECT_FLOAT_EQ(material_of(blend).coverage, 0.25F);
  EXPECT_EQ(material_of(blend).transparent, 0.0F);
}

TEST(GltfMaterial, OneSideUnlessItSaysTwoOrLightGoesThrough) {
  EXPECT_TRUE(material_of({{"doubleSided", false}}).one_sided);
  EXPECT_TRUE(material_of(Json::object()).one_sided);
  EXPECT_FALSE(material_of({{"doubleSided", true}}).one_sided);
  for (const char* name : {"transmission", "diffuse_transmission"}) {
    const std::string factor = name[0] == 't' ? "transmissionFactor" : "diffuseTransmissionFactor";
    const Json extension = {{factor, 0.5}};
    EXPECT_FALSE(material_of({{"extensions", {{std::string("KHR_materials_") + name, extension}}}}).one_sided);
  }
}

TEST(GltfMaterial, EqualNamesStayApart) {
  GltfBuilder builder;
  builder.triangle();
  builder.root["materials"] = {{{"name", "m"}, {"emissiveFactor", {1, 0, 0}}},
                               {{"name", "m"}, {"emissiveFactor", {0, 1, 0}}}};
  builder.root["meshes"][0]["primitives"][0]["material"] = 1;
  const auto imported = scene_of(builder);
  ASSERT_EQ(imported.scene.materials.size(), 2U);
  const Material& used = imported.scene.materials[imported.scene.mesh.material_ids[0]];
  EXPECT_EQ(used.emission, Rgb(0, 1, 0));
  EXPECT_NE(imported.scene.materials[0].name, imported.scene.materials[1].name);
}

TEST(Gltf, WhatIsNotShownIsListed) {
  GltfBuilder builder;
  builder.triangle();
  builder.root["animations"] = Json::array();
  builder.root["extensionsUsed"] = {"KHR_materials_clearcoat", "KHR_texture_basisu"};
  builder.root["extensionsRequired"] = {"KHR_texture_basisu"};
  builder.root["materials"] = Json::array();
  builder.root["materials"].push_back(
      {{"extensions", {{"KHR_materials_transmission", {{"transmissionTexture", {{"index", 0}}}}}}},
       {"occlusionTexture", {{"index", 0}}}});
  builder.root["meshes"][0]["primitives"][0]["targets"] = Json::array();
  const auto imported = scene_of(builder);
  EXPECT_EQ(count_of(imported, Warn::kIgnoredExtension), 2U);
  EXPECT_EQ(count_of(imported, Warn::kIgnoredFeature), 2U);
  EXPECT_EQ(count_of(imported, Warn::kIgnoredTexture), 2U);
}

// Alpha of corners would fade the sheet by the format; it is left out, and that is said.
TEST(Gltf, VertexColoursAndTheirAlphaAreListed) {
  GltfBuilder builder;
  const std::vector<float> faded{1, 0, 0, 0, 0, 1, 0, 0.5F, 0, 0, 1, 0};
  const int positions = builder.vec3({0, 0, 0, 1, 0, 0, 0, 1, 0});
  const int colours = builder.accessor(builder.view(faded), 5126, 3, "VEC4");
  builder.primitive({{"attributes", {{"POSITION", positions}, {"COLOR_0", colours}}}, {"material", 0}});
  builder.root["materials"] = Json::array({{{"alphaMode", "BLEND"}, {"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 0.5, 0.5, 0.75}}}}}});
  const auto imported = scene_of(builder);
  EXPECT_EQ(count_of(imported, Warn::kIgnoredFeature), 1U);
  EXPECT_TRUE(std::any_of(imported.report.warnings.begin(), imported.report.warnings.end(),
                          [](const ImportWarning& w) { return w.message == "vertex colours and their alpha are ignored"; }));
  EXPECT_EQ(imported.scene.materials[imported.scene.mesh.material_ids[0]].coverage, 0.75F) << "that of the material";
}

TEST(Gltf, FarAwaySinglePrecisionIsListed) {
  GltfBuilder builder;
  builder.primitive({{"attributes", {{"POSITION", builder.vec3({1e6F, 0, 0, 1e6F + 1, 0, 0, 1e6F, 1, 0})}}}});
  EXPECT_EQ(count_of(scene_of(builder), Warn::kCoarseCoordinates), 1U);
}

}  // namespace
}  // namespace raykiln::render::test
