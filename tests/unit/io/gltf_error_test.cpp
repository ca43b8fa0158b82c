// What the glTF and GLB readers refuse, and where they say it is.
#include <functional>
#include <limits>
#include <string>

#include "support/io/gltf_builder.hpp"
#include "support/io/import_text.hpp"

namespace raykiln::render::test {
namespace {

using Code = ImportErrorCode;
using Json = nlohmann::json;
constexpr std::uint64_t kHuge = std::numeric_limits<std::uint64_t>::max();

struct Row {
  const char* name;
  std::function<void(GltfBuilder&)> damage;
  Code code;
  const char* where;
};

class GltfRefuses : public testing::TestWithParam<Row> {};

// An indexed triangle with normals and a material; each row breaks one thing.
TEST_P(GltfRefuses, WithItsPlace) {
  GltfBuilder builder;
  const int position = builder.vec3({0, 0, 0, 1, 0, 0, 0, 1, 0});
  const int normal = builder.vec3({0, 0, 1, 0, 0, 1, 0, 0, 1});
  builder.primitive({{"attributes", {{"POSITION", position}, {"NORMAL", normal}}},
                     {"indices", builder.indices({0, 1, 2})},
                     {"material", 0}});
  builder.root["materials"] = Json::array({Json::object()});
  GetParam().damage(builder);
  const ImportError error = expect_error({{"a.gltf", builder.gltf()}});
  EXPECT_EQ(name(error.code), name(GetParam().code)) << error.message;
  EXPECT_EQ(error.where, GetParam().where) << error.message;
  EXPECT_EQ(error.file, "a.gltf");
}

INSTANTIATE_TEST_SUITE_P(
    All, GltfRefuses,
    testing::Values(
        Row{"no_asset", [](auto& b) { b.root.erase("asset"); }, Code::kMissingField, ""},
        Row{"version_1", [](auto& b) { b.root["asset"]["version"] = "1.0"; },
            Code::kUnsupportedVersion, "/asset"},
        Row{"version_number", [](auto& b) { b.root["asset"]["version"] = 2; },
            Code::kUnsupportedVersion, "/asset"},
        Row{"draco", [](auto& b) { b.root["extensionsRequired"] = {"KHR_draco_mesh_compression"}; },
            Code::kUnsupportedExtension, "/extensionsRequired/0"},
        Row{"meshopt", [](auto& b) { b.root["extensionsRequired"] = {"KHR_materials_ior", "EXT_meshopt_compression"}; },
            Code::kUnsupportedExtension, "/extensionsRequired/1"},
        Row{"scene", [](auto& b) { b.root["scene"] = 5; }, Code::kIndexOutOfRange, "/scene"},
        Row{"node", [](auto& b) { b.root["scenes"][0]["nodes"] = {7}; }, Code::kIndexOutOfRange, ""},
        Row{"node_negative", [](auto& b) { b.root["scenes"][0]["nodes"] = {-1}; },
            Code::kWrongType, "/scenes/0/nodes/0"},
        Row{"cycle_of_one", [](auto& b) { b.root["nodes"][0]["children"] = {0}; },
            Code::kNodeCycle, "/nodes/0"},
        Row{"cycle_of_two", [](auto& b) {
              b.root["nodes"][0]["children"] = {1};
              b.root["nodes"].push_back({{"children", {0}}});
            }, Code::kNodeCycle, "/nodes/0"},
        Row{"chain", [](auto& b) {
              for (int i = 0; i < 5000; ++i) {
                b.root["nodes"][i]["children"] = {i + 1};
                b.root["nodes"].push_back(Json::object());
              }
            }, Code::kLimitExceeded, "/nodes/256"},
        Row{"doubling", [](auto& b) {
              for (int i = 0; i < 40; ++i) {
                b.root["nodes"][i] = {{"children", {i + 1, i + 1}}};
                b.root["nodes"].push_back(Json::object());
              }
            }, Code::kLimitExceeded, "/nodes/39"},  // where the millionth visit falls
        Row{"mesh", [](auto& b) { b.root["nodes"][0]["mesh"] = 3; }, Code::kIndexOutOfRange, "/nodes/0/mesh"},
        Row{"no_primitives", [](auto& b) { b.root["meshes"][0].erase("primitives"); },
            Code::kMissingField, "/meshes/0"},
        Row{"no_attributes", [](auto& b) { b.root["meshes"][0]["primitives"][0].erase("attributes"); },
            Code::kMissingField, "/meshes/0/primitives/0"},
        Row{"mode", [](auto& b) { b.root["meshes"][0]["primitives"][0]["mode"] = 7; },
            Code::kInvalidValue, "/meshes/0/primitives/0"},
        Row{"material", [](auto& b) { b.root["meshes"][0]["primitives"][0]["material"] = 1; },
            Code::kIndexOutOfRange, "/meshes/0/primitives/0"},
        Row{"accessor", [](auto& b) { b.root["meshes"][0]["primitives"][0]["indices"] = 9; },
            Code::kIndexOutOfRange, "/meshes/0/primitives/0/indices"},
        Row{"count_huge", [](auto& b) { b.root["accessors"][0]["count"] = 4'000'000'000U; },
            Code::kLimitExceeded, "/meshes/0/primitives/0"},
        Row{"count_large", [](auto& b) { b.root["accessors"][0]["count"] = 40'000'000U; },
            Code::kBufferOutOfRange, "/accessors/0"},
        Row{"count_wraps", [](auto& b) { b.root["accessors"][2]["count"] = kHuge; },
            Code::kBufferOutOfRange, "/accessors/2"},
        Row{"count_no_bytes", [](auto& b) {
              b.root["accessors"][0].erase("bufferView");
              b.root["accessors"][0]["count"] = 40'000'000U;
              b.root["accessors"][0]["sparse"] = {{"count", 1}};
            }, Code::kLimitExceeded, "/accessors/0"},
        Row{"offset_wraps", [](auto& b) { b.root["accessors"][0]["byteOffset"] = kHuge - 3; },
            Code::kBufferOutOfRange, "/accessors/0"},
        Row{"view_offset_wraps", [](auto& b) { b.root["bufferViews"][0]["byteOffset"] = kHuge - 3; },
            Code::kBufferOutOfRange, "/bufferViews/0"},
        Row{"view_too_long", [](auto& b) { b.root["bufferViews"][0]["byteLength"] = 1 << 20; },
            Code::kBufferOutOfRange, "/bufferViews/0"},
        Row{"stride_small", [](auto& b) { b.root["bufferViews"][0]["byteStride"] = 4; },
            Code::kBufferOutOfRange, "/accessors/0"},
        Row{"stride_large", [](auto& b) { b.root["bufferViews"][0]["byteStride"] = kHuge; },
            Code::kBufferOutOfRange, "/bufferViews/0"},
        Row{"no_view", [](auto& b) { b.root["accessors"][0]["bufferView"] = 99; },
            Code::kIndexOutOfRange, "/accessors/0"},
        Row{"no_buffer", [](auto& b) { b.root["bufferViews"][0]["buffer"] = 1; },
            Code::kIndexOutOfRange, "/bufferViews/0"},
        Row{"component_type", [](auto& b) { b.root["accessors"][0]["componentType"] = 5130; },
            Code::kInvalidValue, "/accessors/0"},
        Row{"type", [](auto& b) { b.root["accessors"][0]["type"] = "VEC2"; },
            Code::kInvalidValue, "/accessors/0"},
        Row{"index_type", [](auto& b) {
              b.root["accessors"][2]["componentType"] = 5122;
            }, Code::kInvalidValue, "/accessors/2"},
        Row{"index_range", [](auto& b) { b.root["meshes"][0]["primitives"][0]["indices"] = b.indices({0, 1, 3}); },
            Code::kIndexOutOfRange, "/meshes/0/primitives/0/indices"},
        Row{"normals_missing_some", [](auto& b) { b.root["accessors"][1]["count"] = 2; },
            Code::kInvalidValue, "/meshes/0/primitives/0/attributes/NORMAL"},
        Row{"nan", [](auto& b) {
              const float nan = std::numeric_limits<float>::quiet_NaN();
              b.root["meshes"][0]["primitives"][0]["attributes"]["POSITION"] =
                  b.vec3({0, 0, 0, 1, nan, 0, 0, 1, 0});
            }, Code::kNotFinite, "/accessors/3"},
        Row{"far", [](auto& b) { b.root["nodes"][0]["translation"] = {1e16, 0, 0}; },
            Code::kCoordinateTooLarge, "/meshes/0/primitives/0/attributes/POSITION"},
        Row{"transform_overflows", [](auto& b) { b.root["nodes"][0]["scale"] = {1e308, 1e308, 1e308}; },
            Code::kCoordinateTooLarge, "/meshes/0/primitives/0/attributes/POSITION"},
        Row{"matrix_size", [](auto& b) { b.root["nodes"][0]["matrix"] = {1, 2, 3}; },
            Code::kWrongType, "/nodes/0/matrix"},
        Row{"sparse_index", [](auto& b) {
              const int i = b.template view<std::uint8_t>({200});
              const int v = b.template view<float>({0, 0, 0});
              b.root["accessors"][0]["sparse"] = {{"count", 1},
                  {"indices", {{"bufferView", i}, {"componentType", 5121}}}, {"values", {{"bufferView", v}}}};
            }, Code::kIndexOutOfRange, "/accessors/0/sparse/indices"},
        Row{"sparse_count", [](auto& b) {
              b.root["accessors"][0]["sparse"] = {{"count", 4},
                  {"indices", {{"bufferView", 0}, {"componentType", 5121}}}, {"values", {{"bufferView", 0}}}};
            }, Code::kInvalidValue, "/accessors/0/sparse"},
        Row{"remote", [](auto& b) { b.root["buffers"] = {{{"byteLength", 9}, {"uri", "https://example.org/a.bin"}}}; },
            Code::kFileMissing, "/buffers/0/uri"},
        Row{"outside", [](auto& b) { b.root["buffers"] = {{{"byteLength", 9}, {"uri", "%2e%2e/a.bin"}}}; },
            Code::kFileMissing, "/buffers/0/uri"},
        Row{"base64", [](auto& b) { b.root["buffers"] = {{{"byteLength", 9}, {"uri", "data:;base64,@@@@"}}}; },
            Code::kInvalidValue, "/buffers/0/uri"},
        Row{"short_buffer", [](auto& b) { b.root["buffers"] = {{{"byteLength", 1000}, {"uri", "data:;base64,AAAA"}}}; },
            Code::kBufferOutOfRange, "/buffers/0"},
        Row{"no_uri", [](auto& b) { b.root["buffers"] = {{{"byteLength", 4}}}; },
            Code::kMissingField, "/buffers/0"},
        Row{"buffer_size_wraps", [](auto& b) { b.root["buffers"] = {{{"byteLength", kHuge}, {"uri", "data:;base64,AAAA"}}}; },
            Code::kBufferOutOfRange, "/buffers/0"},
        Row{"roughness", [](auto& b) { b.root["materials"][0]["pbrMetallicRoughness"]["roughnessFactor"] = 2; },
            Code::kInvalidValue, "/materials/0/pbrMetallicRoughness/roughnessFactor"},
        Row{"base_color", [](auto& b) { b.root["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = {1, 1, 1}; },
            Code::kWrongType, "/materials/0/pbrMetallicRoughness/baseColorFactor"},
        Row{"alpha_mode", [](auto& b) { b.root["materials"][0]["alphaMode"] = "HALF"; },
            Code::kInvalidValue, "/materials/0/alphaMode"},
        Row{"emission", [](auto& b) { b.root["materials"][0]["emissiveFactor"] = {1, -1, 1}; },
            Code::kInvalidValue, "/materials/0/emissiveFactor"},
        Row{"yfov", [](auto& b) {
              b.root["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 4}}}}};
              b.root["nodes"][0]["camera"] = 0;
            }, Code::kInvalidValue, "/cameras/0/perspective/yfov"},
        Row{"light", [](auto& b) { b.root["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0; },
            Code::kIndexOutOfRange, "/nodes/0"},
        Row{"empty", [](auto& b) { b.root["nodes"][0].erase("mesh"); }, Code::kEmptyScene, ""},
        Row{"meshes_object", [](auto& b) { b.root["meshes"] = Json::object(); }, Code::kWrongType, "/meshes"},
        Row{"nodes_number", [](auto& b) { b.root["nodes"] = 3; }, Code::kWrongType, "/nodes"},
        Row{"node_null", [](auto& b) { b.root["nodes"][0] = nullptr; }, Code::kWrongType, "/nodes/0"}),
    [](const auto& row) { return std::string(row.param.name); });

TEST(Gltf, InstancesStopAtTheTriangleLimit) {
  GltfBuilder builder;
  builder.triangle();
  Json children = Json::array();
  for (int i = 1; i <= 100; ++i) {
    builder.root["nodes"].push_back({{"mesh", 0}});
    children.push_back(i);
  }
  builder.root["scenes"][0]["nodes"] = children;
  ImportOptions options;
  options.limits.max_triangles = 99;
  EXPECT_EQ(expect_error({{"a.gltf", builder.gltf()}}, options).code, Code::kLimitExceeded);
  options.limits.max_triangles = 100;
  EXPECT_EQ(expect_scene({{"a.gltf", builder.gltf()}}, options).scene.mesh.triangles.size(), 100U);
}

struct Damage {
  const char* name;
  std::function<std::string(std::string)> apply;
  Code code;
};

class GlbRefuses : public testing::TestWithParam<Damage> {};

TEST_P(GlbRefuses, TheContainer) {
  GltfBuilder builder;
  builder.triangle();
  const ImportError error = expect_error({{"a.glb", GetParam().apply(builder.glb())}});
  EXPECT_EQ(name(error.code), name(GetParam().code)) << error.message;
}

std::string with_word(std::string bytes, std::size_t at, std::size_t value) {
  const std::string word = GltfBuilder::word(value);
  for (std::size_t i = 0; i < 4; ++i) bytes[at + i] = word[i];
  return bytes;
}

INSTANTIATE_TEST_SUITE_P(
    All, GlbRefuses,
    testing::Values(
        Damage{"empty", [](auto) { return std::string(); }, Code::kInvalidGlb},
        Damage{"magic", [](auto s) { return with_word(s, 0, 1); }, Code::kInvalidGlb},
        Damage{"version", [](auto s) { return with_word(s, 4, 1); }, Code::kUnsupportedVersion},
        Damage{"length_too_long", [](auto s) { return with_word(s, 8, s.size() + 4); }, Code::kInvalidGlb},
        Damage{"length_tiny", [](auto s) { return with_word(s, 8, 3); }, Code::kInvalidGlb},
        Damage{"truncated", [](auto s) { return s.substr(0, s.size() - 8); }, Code::kInvalidGlb},
        Damage{"header_only", [](auto s) { return with_word(s.substr(0, 12), 8, 12); }, Code::kInvalidGlb},
        Damage{"chunk_too_long", [](auto s) { return with_word(s, 12, 0xFFFFFFF0U); }, Code::kInvalidGlb},
        Damage{"chunk_type", [](auto s) { return with_word(s, 16, 77); }, Code::kInvalidGlb},
        Damage{"json", [](auto s) { s[20] = '!'; return s; }, Code::kInvalidJson}),
    [](const auto& row) { return std::string(row.param.name); });

}  // namespace
}  // namespace raykiln::render::test
