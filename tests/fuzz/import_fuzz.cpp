// Deterministic mutation fuzzing of every reader: whatever the bytes, an import ends with a sound
// scene or with an error that has a code, a message and clean text. Run it under asan-ubsan.
// RAYKILN_FUZZ_ITERATIONS and RAYKILN_FUZZ_SEED change the amount and the start.
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <random>
#include <string>
#include <vector>

#include "support/io/gltf_builder.hpp"
#include "support/io/import_text.hpp"

namespace raykiln::render::test {
namespace {

#if defined(__SANITIZE_ADDRESS__)
constexpr std::uint64_t kIterations = 4'000;  // each costs several times more
#else
constexpr std::uint64_t kIterations = 20'000;
#endif

std::uint64_t from_environment(const char* name, std::uint64_t fallback) {
  const char* text = std::getenv(name);
  return text != nullptr ? std::strtoull(text, nullptr, 10) : fallback;
}


// Values that once broke somebody's parser.
const std::vector<std::string> kNumbers{
    "0", "-1", "1", "nan", "inf", "1e308", "-1e308", "1e999", "1e-999", "2147483648",
    "4294967295", "4294967296", "18446744073709551615", "9223372036854775807", "1e400000000",
    "0x7fffffff", "-", "", "1.5", "99999999999999999999999", "null", "[]", "{}", "\"\"", "true"};

const std::vector<std::string> kWords{
    "f ", "v ", "vn ", "usemtl ", "mtllib ", "\n", "\\\n", "/", "//", "#", "newmtl ", "Kd ", "d ",
    "\"count\":", "\"byteOffset\":", "\"sparse\":", "\"children\":[0]", "\"matrix\":[1]", "[", "]",
    "{", "}", ",", "\"", "\\u0000", "\xEF\xBB\xBF", "\xFF\xFE", std::string(1, '\0')};

class Mutator {
 public:
  explicit Mutator(std::uint64_t seed) : random_(seed) {}

  std::string operator()(std::string bytes, const std::string& other) {
    const std::size_t steps = 1 + below(4);
    for (std::size_t i = 0; i < steps; ++i) step(bytes, other);
    return bytes;
  }
  std::size_t below(std::size_t n) { return n == 0 ? 0 : random_() % n; }

 private:
  void step(std::string& bytes, const std::string& other) {
    const std::size_t at = below(bytes.size() + 1);
    switch (below(8)) {
      case 0: if (at < bytes.size()) bytes[at] = static_cast<char>(below(256)); break;
      case 1: if (at < bytes.size()) bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8))); break;
      case 2: bytes.resize(at); break;
      case 3: bytes.erase(at, 1 + below(40)); break;
      case 4: bytes.insert(at, kWords[below(kWords.size())]); break;
      case 5: replace_number(bytes, at); break;
      case 6: bytes.insert(at, other.substr(below(other.size()), 1 + below(200))); break;
      default: bytes.insert(at, bytes.substr(below(bytes.size()), 1 + below(60))); break;
    }
  }
  void replace_number(std::string& bytes, std::size_t at) {
    const std::size_t begin = bytes.find_first_of("0123456789", at);
    if (begin == std::string::npos) return;
    const std::size_t end = std::min(bytes.find_first_not_of("0123456789.eE+-", begin), bytes.size());
    bytes.replace(begin, end - begin, kNumbers[below(kNumbers.size())]);
  }
  std::mt19937_64 random_;
};

// Small enough that a mutant cannot make a slow test out of a legal request.
ImportOptions small_limits() {
  ImportOptions options;
  options.limits.max_triangles = 20'000;
  options.limits.max_vertices = 20'000;
  options.limits.max_node_visits = 10'000;
  return options;
}

void check(const ImportResult& result) {
  if (const auto* imported = std::get_if<ImportedScene>(&result)) {
    expect_sound(*imported);
    return;
  }
  const auto& error = std::get<ImportError>(result);
  ASSERT_NE(name(error.code), "unknown");
  ASSERT_FALSE(error.message.empty());
  for (const std::string* text : {&error.message, &error.file, &error.where, &error.remedy}) {
    for (const char c : *text) ASSERT_GE(static_cast<unsigned char>(c), 0x20U);
    // nlohmann refuses to dump what is not UTF-8; error texts travel in JSON.
    ASSERT_NO_THROW((void)nlohmann::json(*text).dump());
  }
}

// `target` is the file that is mutated, `others` are other texts to splice from.
void fuzz(const Texts& base, const std::string& target, const std::vector<std::string>& others) {
  const std::uint64_t seed = from_environment("RAYKILN_FUZZ_SEED", 20'250'101);
  const std::uint64_t iterations = from_environment("RAYKILN_FUZZ_ITERATIONS", kIterations);
  std::cout << "seed " << seed << ", " << iterations << " iterations\n";
  const ImportOptions options = small_limits();
  ASSERT_TRUE(std::holds_alternative<ImportedScene>(import_texts(base, options)));
  std::uint64_t accepted = 0;
  for (std::uint64_t i = 0; i < iterations; ++i) {
    Mutator mutate(seed * 1'000'003 + i);
    Texts files = base;
    files[target] = mutate(files[target], others[mutate.below(others.size())]);
    try {
      const ImportResult result = import_texts(files, options);
      accepted += std::holds_alternative<ImportedScene>(result) ? 1U : 0U;
      check(result);
    } catch (const std::exception& thrown) {
      ADD_FAILURE() << "imports do not throw: " << thrown.what();
    }
    if (testing::Test::HasFailure()) {
      std::ofstream("fuzz_failure.bin", std::ios::binary) << files[target];
      FAIL() << "iteration " << i << "; the input is in fuzz_failure.bin";
    }
  }
  std::cout << accepted << " mutants were accepted\n";
  EXPECT_GT(accepted, iterations / 100) << "mutants that are all refused test nothing";
  EXPECT_LT(accepted, iterations) << "mutants that are all accepted test nothing";
}

const std::string kObj =
    "mtllib m.mtl\nv 0 0 0 1\nv 1 0 0\nv 1 1 0.5\nv 0 1 0\nv 2 0.25 -1e-3\nvn 0 0 1\nvn 0 1 0\n"
    "vt 0 0\ng group\nusemtl a\ns off\nf 1 2 3 4\nf 1/1/1 2/1/2 \\\n 3/1/1\nusemtl b c\n"
    "f -1//-1 -2//-1 -3//-2 1//1 2//2\nl 1 2\np 3\nf 1 5 2\n";
const std::string kMtl =
    "newmtl a\nKa 0 0 0\nKd 0.5 0.25 0.125\nKs 0.1 0.1 0.1\nNs 100\nillum 2\nmap_Kd x.png\n"
    "newmtl b c\nKd 0.5\nKe 1 2 3\nd 0.5\nNi 1.5\nTr 0.5\nTf 1 1 1\nillum 7\n";
/// One grey pixel; told by its bytes, whatever it is called.
const std::string kPicture =
    "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n\x80\x80\x80\x80";
const std::string kSidecar = R"({"scene": "a.obj", "scale": 2, "camera": {"eye": [0, 0, 5],
  "look_at": [0, 0, 0], "up": [0, 1, 0], "fov_deg": 40}, "point_lights": [{"position": [0, 2, 0],
  "intensity": [1, 2, 3]}], "background": [0, 0, 0.1], "materials": {"a": {"diffuse": [1, 0, 0],
  "specular": [0, 0, 0], "transparent": 0.5, "specular_exp": 10, "index_of_refraction": 1.5,
  "emission": [0, 0, 0]}}})";

GltfBuilder full_gltf() {
  GltfBuilder builder;
  const int position = builder.vec3({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0});
  const int normal = builder.vec3({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});
  const int sparse_indices = builder.view<std::uint8_t>({2});
  const int sparse_values = builder.view<float>({0, 2, 0});
  builder.root["accessors"][position]["sparse"] = {
      {"count", 1},
      {"indices", {{"bufferView", sparse_indices}, {"componentType", 5121}}},
      {"values", {{"bufferView", sparse_values}}}};
  builder.primitive({{"attributes", {{"POSITION", position}, {"NORMAL", normal}}},
                     {"indices", builder.indices({0, 1, 2, 1, 3, 2})},
                     {"material", 0}});
  builder.primitive({{"attributes", {{"POSITION", position}}}, {"mode", 5}});
  builder.root["materials"] = {{{"name", "m"},
                                {"pbrMetallicRoughness", {{"baseColorFactor", {1, 0.5, 0, 0.5}}, {"metallicFactor", 0.5}, {"roughnessFactor", 0.25}}},
                                {"alphaMode", "BLEND"},
                                {"emissiveFactor", {0, 0.5, 0}}}};
  builder.root["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.8}}}}};
  builder.root["extensionsUsed"] = {"KHR_lights_punctual"};
  builder.root["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"intensity", 8}}};
  builder.root["nodes"].push_back({{"translation", {0, 0, 2}}, {"rotation", {0, 0, 0, 1}}, {"camera", 0}, {"children", {2}}});
  builder.root["nodes"].push_back({{"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 3, 0, 0, 1}}, {"mesh", 0}});
  builder.root["nodes"][2]["extensions"]["KHR_lights_punctual"]["light"] = 0;
  builder.root["scenes"][0]["nodes"] = {0, 1};
  const int uv = builder.accessor(builder.view<float>({0, 0, 1, 0, 0, 1, 1, 1}), 5126, 4, "VEC2");
  builder.root["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = uv;
  const std::vector<std::uint8_t> picture(kPicture.begin(), kPicture.end());
  builder.root["images"] = {{{"bufferView", builder.view<std::uint8_t>(picture)}},
                            {{"uri", "data:image/png;base64,AAAA"}}};
  builder.root["samplers"] = {{{"wrapS", 33071}, {"magFilter", 9728}}};
  builder.root["textures"] = {{{"source", 0}, {"sampler", 0}}};
  auto& material = builder.root["materials"][0];
  material["pbrMetallicRoughness"]["baseColorTexture"] = {
      {"index", 0}, {"texCoord", 0},
      {"extensions", {{"KHR_texture_transform", {{"offset", {0.5, 0}}, {"rotation", 0.5}, {"scale", {2, 2}}}}}}};
  material["emissiveTexture"]["index"] = 0;
  material["pbrMetallicRoughness"]["metallicRoughnessTexture"]["index"] = 0;
  material["normalTexture"] = {{"index", 0}, {"scale", 0.5}};
  return builder;
}

TEST(Fuzz, Obj) {
  fuzz({{"a.obj", kObj}, {"m.mtl", kMtl}, {"x.png", kPicture}}, "a.obj", {kObj, kMtl, kSidecar});
}
TEST(Fuzz, Mtl) {
  fuzz({{"a.obj", kObj}, {"m.mtl", kMtl}, {"x.png", kPicture}}, "m.mtl", {kMtl, kObj});
}
TEST(Fuzz, Picture) {
  fuzz({{"a.obj", kObj}, {"m.mtl", kMtl}, {"x.png", kPicture}}, "x.png", {kPicture});
}
TEST(Fuzz, Sidecar) {
  fuzz({{"a.obj", kObj}, {"m.mtl", kMtl}, {"x.png", kPicture}, {"raykiln.json", kSidecar}}, "raykiln.json",
       {kSidecar, full_gltf().gltf()});
}
TEST(Fuzz, Gltf) {
  const std::string text = full_gltf().gltf();
  fuzz({{"a.gltf", text}}, "a.gltf", {text, kSidecar});
}
TEST(Fuzz, Glb) {
  const std::string bytes = full_gltf().glb();
  fuzz({{"a.glb", bytes}}, "a.glb", {bytes, full_gltf().gltf()});
}
TEST(Fuzz, GltfBinary) {
  GltfBuilder builder = full_gltf();
  builder.root["buffers"] = nlohmann::json::array({{{"byteLength", builder.bin.size()}, {"uri", "b.bin"}}});
  fuzz({{"a.gltf", builder.gltf()}, {"b.bin", builder.bin}}, "b.bin", {builder.bin});
}

}  // namespace
}  // namespace raykiln::render::test
