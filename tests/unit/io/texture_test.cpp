// Textures of OBJ and glTF: read, placed, shared, refused by name.
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "mtl_map.hpp"
#include "raykiln/image/encode.hpp"
#include "raykiln/scene/surface_textures.hpp"
#include "support/io/import_text.hpp"

namespace raykiln::render::test {
namespace {

using Code = ImportErrorCode;
using Warn = ImportWarningCode;

/// Two triangles with coordinates; v counts upwards.
const std::string kObj =
    "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 0.75\nvt 0 1 0\n"
    "usemtl a\nf 1/1 2/2 3/3\nf 1/1 3/-2 4/-1\n";

std::string png() {
  const Image image{.width = 2, .height = 1, .rgb = {0, 0, 0, 1, 1, 1}};
  const auto bytes = std::get<Bytes>(encode_png(image, 0.0));
  return {bytes.begin(), bytes.end()};
}

ImportedScene obj_scene(const std::string& mtl, const std::string& obj = kObj) {
  return expect_scene({{"a.obj", obj}, {"m.mtl", mtl}, {"tex/x.png", png()}});
}

TEST(ObjTexture, ColourAndCoordinates) {
  const auto imported = obj_scene("newmtl a\nKd 0.5 0.5 0.5\nmap_Kd tex\\x.png\n");
  ASSERT_NE(imported.scene.textures, nullptr);
  const SurfaceTextures& textures = *imported.scene.textures;
  ASSERT_EQ(textures.images.size(), 1U);
  EXPECT_EQ(textures.images[0].name, "tex/x.png");
  EXPECT_EQ(textures.images[0].width, 2);
  EXPECT_EQ(textures.images[0].srgb8, (std::vector<std::uint8_t>{0, 0, 0, 255, 255, 255}));
  const UvSet& set = textures.uv_sets[0];
  ASSERT_EQ(set.corners.size(), 2U);
  EXPECT_EQ(set.coordinates[set.corners[0][2]], Vec2f(1.0F, 0.25F));  // turned to count downwards
  EXPECT_EQ(set.coordinates[set.corners[1][1]], Vec2f(1.0F, 0.25F));
  EXPECT_EQ(set.coordinates[set.corners[1][2]], Vec2f(0.0F, 0.0F));
  const MaterialTextures& used = textures.materials[imported.scene.mesh.material_ids[0]];
  EXPECT_TRUE(used.base.used());
  EXPECT_FALSE(used.emission.used());
  EXPECT_EQ(imported.scene.materials[imported.scene.mesh.material_ids[0]].diffuse, Rgb(0.5F));
  EXPECT_EQ(count_of(imported, Warn::kIgnoredTexture), 0U);
}

TEST(ObjTexture, EmissionIsOneUnlessKeSaysOtherwise) {
  const auto emission = [](const std::string& ke) {
    const auto imported = obj_scene("newmtl a\n" + ke + "map_Ke tex/x.png\n");
    return imported.scene.materials[imported.scene.mesh.material_ids[0]].emission;
  };
  EXPECT_EQ(emission(""), Rgb(1.0F));
  EXPECT_EQ(emission("Ke 3 2 1\n"), Rgb(3, 2, 1));
}

TEST(ObjTexture, SceneWithoutTexturesHasNoCoordinates) {
  EXPECT_EQ(obj_scene("newmtl a\nKd 1 1 1\n").scene.textures, nullptr);
  // A texture of a material that no face has is nothing either.
  EXPECT_EQ(obj_scene("newmtl a\nKd 1 1 1\nnewmtl b\nmap_Kd tex/x.png\n").scene.textures, nullptr);
}

TEST(ObjTexture, OnePictureForTwoMaterialsIsHeldOnce) {
  const auto imported = obj_scene(
      "newmtl a\nmap_Kd tex/x.png\nmap_Ke tex/x.png\nnewmtl b\nmap_Kd tex/x.png\n",
      kObj + "usemtl b\nf 1/1 2/2 4/4\n");
  EXPECT_EQ(imported.scene.textures->images.size(), 1U);
}

TEST(ObjTexture, FacesWithoutCoordinatesAreListed) {
  const auto imported = obj_scene("newmtl a\nmap_Kd tex/x.png\n",
                                  kObj + "f 1 2 4\nf 1/9 2/9 4/9\nf 1/1 2/2 4\n");
  EXPECT_EQ(count_of(imported, Warn::kIgnoredTexture), 3U);
  const UvSet& set = imported.scene.textures->uv_sets[0];
  EXPECT_EQ(set.corners[3][0], kNoUv);
  EXPECT_EQ(set.corners[4][2], kNoUv);
}

// Dropping a flat triangle in front moves the coordinates along.
TEST(ObjTexture, DroppedTrianglesTakeTheirCoordinatesAlong) {
  std::string obj = kObj;
  obj.insert(obj.find("usemtl a\n") + 9, "f 1/1 1/1 2/2\nf 1 2 4\n");
  const auto imported = obj_scene("newmtl a\nmap_Kd tex/x.png\n", obj);
  const UvSet& set = imported.scene.textures->uv_sets[0];
  ASSERT_EQ(imported.scene.mesh.triangles.size(), 3U);
  EXPECT_EQ(set.corners[0][0], kNoUv);
  EXPECT_EQ(set.coordinates[set.corners[1][2]], Vec2f(1.0F, 0.25F));
  EXPECT_EQ(set.coordinates[set.corners[2][2]], Vec2f(0.0F, 0.0F));
}

TEST(ObjTexture, MissingAndUnreadableOnesAreNamed) {
  const auto mtl = [](const std::string& name) { return "newmtl a\nKd 1 1 1\nmap_Kd " + name + "\n"; };
  const ImportError missing = expect_error({{"a.obj", kObj}, {"m.mtl", mtl("y z.png")}});
  EXPECT_EQ(missing.code, Code::kFileMissing);
  EXPECT_NE(missing.message.find("'y z.png'"), std::string::npos) << missing.message;
  EXPECT_EQ(missing.file, "m.mtl");
  EXPECT_EQ(missing.where, "line 3");
  const ImportError damaged = expect_error({{"a.obj", kObj}, {"m.mtl", mtl("x.png")}, {"x.png", "II*"}});
  EXPECT_EQ(damaged.code, Code::kInvalidPicture);
  EXPECT_NE(damaged.message.find("'x.png'"), std::string::npos) << damaged.message;
  for (const char* name : {"y.png", "x.png"}) {
    const auto imported = expect_scene({{"a.obj", kObj}, {"m.mtl", mtl(name)}, {"x.png", "II*"},
                                        {"raykiln.json", R"({"allow_missing": true})"}});
    EXPECT_EQ(count_of(imported, Warn::kIgnoredTexture), 1U);
    EXPECT_EQ(imported.scene.textures, nullptr);
  }
}

TEST(ObjTexture, MemoryIsBounded) {
  ImportOptions options;
  options.limits.max_texture_bytes = 5;
  const Texts files{{"a.obj", kObj}, {"m.mtl", "newmtl a\nmap_Kd x.png\n"}, {"x.png", png()}};
  EXPECT_EQ(expect_error(files, options).code, Code::kLimitExceeded);
  options.limits.max_texture_bytes = 6;
  EXPECT_NE(expect_scene(files, options).scene.textures, nullptr);
  // Refused by its header, before it is decoded.
  options.limits.max_texture_texels = 1;
  EXPECT_EQ(expect_error(files, options).code, Code::kInvalidPicture);
}

std::string exr(const std::vector<float>& rgb) {
  const Image image{.width = static_cast<int>(rgb.size() / 3), .height = 1, .rgb = rgb};
  const auto bytes = std::get<Bytes>(encode_exr(image, {}, {}));
  return {bytes.begin(), bytes.end()};
}

ImportedScene exr_scene(const std::string& mtl, const std::vector<float>& rgb) {
  return expect_scene({{"a.obj", kObj}, {"m.mtl", mtl}, {"x.exr", exr(rgb)}});
}

// Colours are at most 1. Emission keeps its ratio: the picture is divided by a power of two, and the
// factor is multiplied by it.
TEST(ObjTexture, LinearPicturesAreBroughtToOne) {
  const auto colour = exr_scene("newmtl a\nKd 1 1 1\nmap_Kd x.exr\n", {-1, 0.25F, 7, 1, 0, 0.5F});
  EXPECT_EQ(colour.scene.textures->images[0].linear, (std::vector<float>{0, 0.25F, 1, 1, 0, 0.5F}));
  EXPECT_EQ(count_of(colour, Warn::kClampedValue), 2U);
  const auto both = exr_scene("newmtl a\nKd 1 1 1\nKe 3 3 3\nmap_Kd x.exr\nmap_Ke x.exr\n",
                              {0, 0.25F, 7, 1, 0, 0.5F});
  const std::uint32_t id = both.scene.mesh.material_ids[0];
  const MaterialTextures& used = both.scene.textures->materials[id];
  EXPECT_NE(used.base.image, used.emission.image);
  EXPECT_EQ(both.scene.materials[id].emission, Rgb(24.0F));
  EXPECT_EQ(both.scene.textures->images[used.emission.image].linear[2], 0.875F);
  EXPECT_EQ(both.scene.textures->images[used.base.image].linear[2], 1.0F);
}

TEST(ObjTexture, WhatIsNotFiniteOrTooBrightIsRefused) {
  const float inf = std::numeric_limits<float>::infinity();
  for (const float bad : {std::nanf(""), inf, -inf}) {
    const Texts files{{"a.obj", kObj}, {"m.mtl", "newmtl a\nmap_Ke x.exr\n"}, {"x.exr", exr({0, bad, 0})}};
    EXPECT_EQ(expect_error(files).code, Code::kNotFinite);
  }
  const Texts files{{"a.obj", kObj}, {"m.mtl", "newmtl a\nKe 1e20 0 0\nmap_Ke x.exr\n"},
                    {"x.exr", exr({1e20F, 0, 0})}};
  EXPECT_EQ(expect_error(files).code, Code::kInvalidValue);
}

TEST(ObjTexture, AMaterialMayBeDescribedFurtherDown) {
  std::string late = kObj.substr(kObj.find('\n') + 1) + "mtllib m.mtl\n";
  const auto described_late = obj_scene("newmtl a\nmap_Kd tex/x.png\n", late);
  EXPECT_EQ(described_late.scene.textures->uv_sets[0].corners.size(), 2U);
  EXPECT_EQ(count_of(described_late, Warn::kIgnoredTexture), 0U);
}

// A damaged picture is looked at once, however many materials name it.
TEST(ObjTexture, ADamagedPictureIsReadOnce) {
  std::string mtl;
  for (int i = 0; i < 50; ++i) mtl += "newmtl m" + std::to_string(i) + "\nmap_Kd x.png\n";
  ImportOptions options;
  options.allow_missing = true;
  options.limits.max_textures = 1;
  const auto imported = expect_scene(
      {{"a.obj", kObj}, {"m.mtl", mtl + "newmtl a\nKd 1 1 1\n"}, {"x.png", png().substr(0, 40)}}, options);
  EXPECT_EQ(count_of(imported, Warn::kIgnoredTexture), 1U);
}

TEST(MtlMap, OptionsAndNames) {
  const auto read = [](const char* text) { return io::read_mtl_map(text); };
  EXPECT_EQ(read(" my texture.png ").file, "my texture.png");
  EXPECT_EQ(read("-blendu on -mm 0 1 -bm 2 x.png").file, "x.png");
  EXPECT_EQ(read("-blendu on -mm 0 1 -bm 2 x.png").ignored.size(), 3U);
  EXPECT_EQ(read("-odd.png").file, "-odd.png");
  EXPECT_EQ(read("-s 2 2.png").file, "2.png");
  EXPECT_EQ(read("-clamp on x.png").use.wrap_u, TextureWrap::kClamp);
  const io::MtlMap map = read("-s 2 3 1 -o 0.25 0.5 x.png");
  EXPECT_EQ(map.file, "x.png");
  EXPECT_EQ(map.use.u_row, Vec3d(2, 0, 0.25));
  // v_up 0.1 becomes 0.8; counted downwards 0.9 becomes 0.2.
  EXPECT_NEAR(dot(map.use.v_row, Vec3d(0, 0.9, 1)), 0.2, 1e-15);
}

// ---- glTF, written out: one triangle of three vertices with two sets of coordinates.

std::string base64(const std::string& bytes) {
  static constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = group << 8U | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text += i + k <= bytes.size() ? kDigits[group >> (18U - 6U * static_cast<unsigned>(k)) & 63U] : '=';
    }
  }
  return text;
}

std::string floats(const std::vector<float>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float)};
}

/// `material` and the rest as members of the document; image 0 is embedded in the buffer.
Texts gltf(const std::string& material, const std::string& more) {
  const std::string picture = png();
  const std::string buffer = floats({0, 0, 0, 1, 0, 0, 0, 1, 0}) + floats({0, 0, 1, 0, 0, 1}) +
                             floats({0.5F, 0.5F, 0.25F, 0.5F, 0.5F, 0.25F}) + picture;
  const std::string size = std::to_string(buffer.size());
  return {{"a.gltf",
           R"({"asset": {"version": "2.0"}, "nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"material": 0,
             "attributes": {"POSITION": 0, "TEXCOORD_0": 1, "TEXCOORD_1": 2}}]}],
             "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
                           {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2"},
                           {"bufferView": 2, "componentType": 5126, "count": 3, "type": "VEC2"}],
             "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 24},
                             {"buffer": 0, "byteOffset": 60, "byteLength": 24},
                             {"buffer": 0, "byteOffset": 84, "byteLength": )" +
               std::to_string(picture.size()) + R"(}],
             "buffers": [{"byteLength": )" + size + R"(, "uri": "data:application/octet-stream;base64,)" +
               base64(buffer) + R"("}], "materials": [)" + material + "], " + more + "}"},
          {"x y.png", picture}};
}

constexpr const char* kImages =
    R"("images": [{"bufferView": 3, "mimeType": "image/png"}, {"uri": "x%20y.png"}, {"uri": "nowhere.png"},
                  {"uri": "https://example.org/a.png"}],
       "samplers": [{"wrapS": 33648, "wrapT": 33071, "magFilter": 9728}],
       "textures": [{"source": 0}, {"source": 1, "sampler": 0}, {"source": 2}, {"source": 3}, {}])";

std::string base(const std::string& info) {
  return R"({"pbrMetallicRoughness": {"metallicFactor": 0, "baseColorTexture": )" + info + "}}";
}

TEST(GltfTexture, EmbeddedAndBesideTheScene) {
  for (const int texture : {0, 1}) {
    const auto imported =
        expect_scene(gltf(base(R"({"index": )" + std::to_string(texture) + "}"), kImages));
    ASSERT_NE(imported.scene.textures, nullptr);
    const SurfaceTextures& textures = *imported.scene.textures;
    ASSERT_EQ(textures.images.size(), 1U);
    EXPECT_EQ(textures.images[0].srgb8.size(), 6U);
    const TextureUse& use = textures.materials[0].base;
    EXPECT_EQ(use.wrap_u, texture == 0 ? TextureWrap::kRepeat : TextureWrap::kMirror);
    EXPECT_EQ(use.wrap_v, texture == 0 ? TextureWrap::kRepeat : TextureWrap::kClamp);
    EXPECT_EQ(use.filter, texture == 0 ? TextureFilter::kBilinear : TextureFilter::kNearest);
    EXPECT_EQ(textures.uv_sets[0].coordinates,
              (std::vector<Vec2f>{{0, 0}, {1, 0}, {0, 1}}));
    EXPECT_TRUE(textures.uv_sets[1].coordinates.empty());
    EXPECT_EQ(textures.materials[0].specular_tint, Rgb(0.0F));  // a dielectric reflects white
  }
}

TEST(GltfTexture, TransformAndSecondSet) {
  const auto imported = expect_scene(gltf(
      base(R"({"index": 0, "texCoord": 1, "extensions": {"KHR_texture_transform":
               {"offset": [0, 1], "rotation": 1.57079632679, "scale": [0.5, 0.5]}}})"),
      std::string(R"("extensionsRequired": ["KHR_texture_transform"], )") + kImages));
  const TextureUse& use = imported.scene.textures->materials[0].base;
  EXPECT_EQ(use.uv_set, 1);
  // The example of the extension: the lower left quarter of the picture.
  const auto moved = [&](double u, double v) {
    return Vec2f(dot(use.u_row, Vec3d(u, v, 1)), dot(use.v_row, Vec3d(u, v, 1)));
  };
  for (const auto& [u, v, x, y] : {std::array{0.0, 0.0, 0.0, 1.0}, {1.0, 0.0, 0.0, 0.5},
                                   {0.0, 1.0, 0.5, 1.0}, {1.0, 1.0, 0.5, 0.5}}) {
    EXPECT_NEAR(moved(u, v).x, x, 1e-6);
    EXPECT_NEAR(moved(u, v).y, y, 1e-6);
  }
  EXPECT_EQ(imported.scene.textures->uv_sets[1].coordinates[1], Vec2f(0.25F, 0.5F));
  EXPECT_TRUE(imported.scene.textures->uv_sets[0].coordinates.empty());
}

TEST(GltfTexture, MetalsAreTintedAndEmissionIsTextured) {
  const auto imported = expect_scene(gltf(
      R"({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}, "emissiveFactor": [1, 0.5, 0],
          "emissiveTexture": {"index": 1}})", kImages));
  const MaterialTextures& used = imported.scene.textures->materials[0];
  EXPECT_EQ(used.specular_tint, Rgb(1.0F));
  EXPECT_TRUE(used.emission.used());
  EXPECT_EQ(imported.scene.materials[0].emission, Rgb(1, 0.5F, 0));
  EXPECT_EQ(imported.scene.textures->images.size(), 2U);
}

TEST(GltfTexture, RoughnessAndNormalsAreData) {
  const auto imported = expect_scene(gltf(
      R"({"pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.5, 0.5, 1], "roughnessFactor": 0.75,
           "baseColorTexture": {"index": 0}, "metallicRoughnessTexture": {"index": 0}},
          "normalTexture": {"index": 0, "scale": 0.5, "texCoord": 1}})", kImages));
  const MaterialTextures& used = imported.scene.textures->materials[0];
  EXPECT_EQ(imported.scene.textures->images.size(), 1U);
  EXPECT_FALSE(used.base.data);
  EXPECT_TRUE(used.roughness.data && used.normal.data);
  EXPECT_EQ(used.normal_scale, 0.5);
  EXPECT_EQ(used.metal.roughness, 0.75);
  EXPECT_EQ(used.metal.base, Rgb(0.5F));
  EXPECT_EQ(imported.scene.textures->uv_sets[1].corners.size(), 1U);
  EXPECT_EQ(count_of(imported, Warn::kIgnoredTexture), 0U);
}

TEST(GltfTexture, WhatCannotBeHadIsNamed) {
  const auto refused = [](const std::string& info) { return expect_error(gltf(base(info), kImages)); };
  EXPECT_EQ(refused(R"({"index": 2})").code, Code::kFileMissing);
  EXPECT_NE(refused(R"({"index": 2})").message.find("nowhere.png"), std::string::npos);
  EXPECT_EQ(refused(R"({"index": 3})").code, Code::kFileMissing);
  EXPECT_EQ(refused(R"({"index": 4})").code, Code::kInvalidPicture);
  EXPECT_EQ(refused(R"({"index": 5})").code, Code::kIndexOutOfRange);
  EXPECT_EQ(refused(R"({"index": 0, "texCoord": 2})").code, Code::kInvalidValue);
  EXPECT_EQ(refused("{}").code, Code::kMissingField);
  EXPECT_EQ(refused("7").code, Code::kWrongType);
  Texts files = gltf(base(R"({"index": 2})"), kImages);
  files["raykiln.json"] = R"({"allow_missing": true})";
  const auto imported = expect_scene(files);
  EXPECT_EQ(imported.scene.textures, nullptr);
  EXPECT_EQ(count_of(imported, Warn::kIgnoredTexture), 1U);
}

/// 2 x 1 texels of alpha 0 and 200.
std::string png_with_alpha() {
  static constexpr unsigned char kBytes[] = {
      0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44,
      0x52, 0x00, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x01, 0x08, 0x06, 0x00, 0x00, 0x00, 0xf4,
      0x22, 0x7f, 0x8a, 0x00, 0x00, 0x00, 0x11, 0x49, 0x44, 0x41, 0x54, 0x78, 0xda, 0x63, 0xe0,
      0x12, 0x91, 0x63, 0xd0, 0x30, 0xb2, 0x39, 0x01, 0x00, 0x04, 0x0f, 0x01, 0x9b, 0xcc, 0x51,
      0xa4, 0x8a, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};
  return {std::begin(kBytes), std::end(kBytes)};
}

ImportedScene covered(const std::string& mode, const std::string& picture, const char* colour = "1, 1, 1") {
  Texts files = gltf(R"({"pbrMetallicRoughness": {"baseColorFactor": [)" + std::string(colour) +
                         R"(, 0.5], "baseColorTexture": {"index": 1}}, "emissiveFactor": [1, 1, 1])" + mode + "}",
                     kImages);
  files["x y.png"] = picture;
  return expect_scene(files);
}

TEST(GltfTexture, AlphaOfTheBaseColourIsCoverage) {
  for (const char* colour : {"1, 1, 1", "0, 0, 0"}) {  // the colour of black is not read, its alpha is
    const auto mask = covered(R"(, "alphaMode": "MASK", "alphaCutoff": 0.25)", png_with_alpha(), colour);
    ASSERT_NE(mask.scene.textures, nullptr);
    const MaterialTextures& used = mask.scene.textures->materials[0];
    ASSERT_TRUE(used.alpha.used());
    EXPECT_EQ(used.base.used(), colour[0] == '1');
    EXPECT_EQ(used.alpha_cutoff, 0.25);
    EXPECT_EQ(used.alpha.wrap_u, TextureWrap::kMirror);
    const TextureImage& image = mask.scene.textures->images[used.alpha.image];
    EXPECT_EQ(image.channels, 1);
    EXPECT_EQ(image.srgb8, (std::vector<std::uint8_t>{0, 200}));
    EXPECT_EQ(mask.scene.materials[0].coverage, 0.5F);
    EXPECT_EQ(mask.scene.materials[0].emission, Rgb(1.0F));
    EXPECT_EQ(mask.scene.textures->uv_sets[0].corners.size(), 1U);
    EXPECT_EQ(count_of(mask, Warn::kIgnoredFeature), 0U);
  }
  const auto blend = covered(R"(, "alphaMode": "BLEND")", png_with_alpha());
  EXPECT_TRUE(blend.scene.textures->materials[0].alpha.used());
  EXPECT_FALSE(blend.scene.textures->materials[0].alpha_cutoff.has_value());
  EXPECT_EQ(blend.scene.materials[0].coverage, 0.5F);
  const auto opaque = covered("", png_with_alpha());
  EXPECT_FALSE(opaque.scene.textures->materials[0].alpha.used());
  EXPECT_EQ(opaque.scene.materials[0].coverage, 1.0F);
}

TEST(GltfTexture, APictureWithoutAlphaLeavesTheFactor) {
  const auto blend = covered(R"(, "alphaMode": "BLEND")", png());
  EXPECT_FALSE(blend.scene.textures->materials[0].alpha.used());
  EXPECT_EQ(blend.scene.materials[0].coverage, 0.5F);
  const auto shown = covered(R"(, "alphaMode": "MASK")", png());
  EXPECT_EQ(shown.scene.materials[0].coverage, 1.0F);
  const auto hidden = covered(R"(, "alphaMode": "MASK", "alphaCutoff": 0.6)", png());
  EXPECT_EQ(hidden.scene.materials[0].coverage, 0.0F);
}

TEST(GltfTexture, DiffuseTransmissionHasAShareAndAColour) {
  const auto leaf = [](const char* share) {
    Texts files = gltf(R"({"pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.5, 0.5, 1], "metallicFactor": 0},
        "extensions": {"KHR_materials_diffuse_transmission": {"diffuseTransmissionFactor": )" +
                           std::string(share) + R"(, "diffuseTransmissionColorFactor": [1, 0.5, 0.25],
          "diffuseTransmissionTexture": {"index": 1}, "diffuseTransmissionColorTexture": {"index": 0}}}})",
                       std::string(R"("extensionsRequired": ["KHR_materials_diffuse_transmission"], )") + kImages);
    files["x y.png"] = png_with_alpha();
    return expect_scene(files);
  };
  const auto imported = leaf("0.75");
  const Material& material = imported.scene.materials[0];
  EXPECT_EQ(material.diffuse, Rgb(0.125F));
  EXPECT_EQ(material.facets.diffuse_through, Rgb(0.75F, 0.375F, 0.1875F));
  const MaterialTextures& used = imported.scene.textures->materials[0];
  EXPECT_EQ(used.metal.through, 0.75F);
  EXPECT_EQ(imported.scene.textures->images[used.through.image].srgb8, (std::vector<std::uint8_t>{0, 200}));
  EXPECT_EQ(imported.scene.textures->images[used.through_colour.image].channels, 3);
  EXPECT_EQ(leaf("0").scene.textures, nullptr);
}

TEST(ObjTexture, OpacityIsTheAlphaOrTheBrightnessOfItsPicture) {
  const std::string mtl = "newmtl a\nKd 1 1 1\nd 0.5\nmap_d tex/x.png\n";
  for (const bool alpha : {true, false}) {
    const auto imported =
        expect_scene({{"a.obj", kObj}, {"m.mtl", mtl}, {"tex/x.png", alpha ? png_with_alpha() : png()}});
    ASSERT_NE(imported.scene.textures, nullptr);
    const std::uint32_t id = imported.scene.mesh.material_ids[0];
    const MaterialTextures& used = imported.scene.textures->materials[id];
    ASSERT_TRUE(used.alpha.used());
    EXPECT_FALSE(used.alpha_cutoff.has_value());
    EXPECT_EQ(imported.scene.textures->images[0].srgb8,
              alpha ? (std::vector<std::uint8_t>{0, 200}) : (std::vector<std::uint8_t>{0, 255}));
    EXPECT_EQ(imported.scene.materials[id].coverage, 0.5F);  // no longer a pane
    EXPECT_EQ(imported.scene.materials[id].transparent, 0.0F);
  }
}

TEST(GltfTexture, ATextureOfBlackIsNotRead) {
  const auto imported = expect_scene(gltf(
      R"({"pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1], "baseColorTexture": {"index": 2}},
          "emissiveTexture": {"index": 2}})", kImages));
  EXPECT_EQ(imported.scene.textures, nullptr);
}

}  // namespace
}  // namespace raykiln::render::test
