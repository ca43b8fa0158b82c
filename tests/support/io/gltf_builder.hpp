// Small glTF files made in memory, for tests.
#pragma once

#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace raykiln::render::test {

inline std::string base64(std::string_view bytes) {
  static constexpr char kDigits[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto byte = i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U;
      bits = (bits << 8) | byte;
    }
    for (std::size_t k = 0; k < 4; ++k) {
      const bool used = i + k < bytes.size() + 1;
      text += used ? kDigits[(bits >> (18 - 6 * k)) & 63U] : '=';
    }
  }
  return text;
}

class GltfBuilder {
 public:
  using Json = nlohmann::json;

  GltfBuilder() {
    root = {{"asset", {{"version", "2.0"}}}, {"scene", 0}};
    root["scenes"] = Json::array({{{"nodes", Json::array({0})}}});
    root["nodes"] = Json::array({{{"mesh", 0}}});
  }

  template <typename T>
  int view(const std::vector<T>& values, int stride = 0) {
    while (bin.size() % 4 != 0) bin.push_back('\0');
    Json made = {{"buffer", 0}, {"byteOffset", bin.size()}, {"byteLength", values.size() * sizeof(T)}};
    if (stride > 0) made["byteStride"] = stride;
    bin.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    root["bufferViews"].push_back(made);
    return static_cast<int>(root["bufferViews"].size()) - 1;
  }

  int accessor(int view_id, int component_type, std::size_t count, const std::string& type) {
    root["accessors"].push_back({{"bufferView", view_id},
                                 {"componentType", component_type},
                                 {"count", count},
                                 {"type", type}});
    return static_cast<int>(root["accessors"].size()) - 1;
  }

  int vec3(const std::vector<float>& xyz) { return accessor(view(xyz), 5126, xyz.size() / 3, "VEC3"); }
  int indices(const std::vector<std::uint16_t>& ids) {
    return accessor(view(ids), 5123, ids.size(), "SCALAR");
  }

  void primitive(const Json& made) {
    if (!root.contains("meshes")) root["meshes"] = Json::array({{{"primitives", Json::array()}}});
    root["meshes"][0]["primitives"].push_back(made);
  }

  /// One right triangle of area 1/2 in the plane z = 0, normal +z.
  GltfBuilder& triangle() {
    primitive({{"attributes", {{"POSITION", vec3({0, 0, 0, 1, 0, 0, 0, 1, 0})}}}});
    return *this;
  }

  [[nodiscard]] std::string gltf() const {
    Json whole = root;
    if (!bin.empty() && !whole.contains("buffers")) {
      whole["buffers"] = Json::array(
          {{{"byteLength", bin.size()},
            {"uri", "data:application/octet-stream;base64," + base64(bin)}}});
    }
    return whole.dump();
  }

  [[nodiscard]] std::string glb() const {
    Json whole = root;
    if (!whole.contains("buffers")) whole["buffers"] = Json::array({{{"byteLength", bin.size()}}});
    std::string json = whole.dump();
    while (json.size() % 4 != 0) json.push_back(' ');
    std::string binary = bin;
    while (binary.size() % 4 != 0) binary.push_back('\0');
    std::string bytes = "glTF" + word(2) + word(12 + 8 + json.size() + 8 + binary.size());
    bytes += word(json.size()) + "JSON" + json;
    bytes += word(binary.size()) + std::string("BIN\0", 4) + binary;
    return bytes;
  }

  static std::string word(std::size_t value) {
    const auto small = static_cast<std::uint32_t>(value);
    std::string bytes(4, '\0');
    std::memcpy(bytes.data(), &small, 4);
    return bytes;
  }

  Json root;
  std::string bin;
};

}  // namespace raykiln::render::test
