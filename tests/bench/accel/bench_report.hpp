// What both benchmarks of the tree share: clocks, the machine, JSON, meshes by name.
#pragma once

#include <time.h>

#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "support/mesh_generators.hpp"

namespace raykiln::bench {

struct Seconds {
  double wall = 0.0;
  double cpu = 0.0;  ///< of all threads of the process
};

class Stopwatch {
 public:
  [[nodiscard]] Seconds elapsed() const {
    return {std::chrono::duration<double>(std::chrono::steady_clock::now() - wall_).count(),
            cpu_now() - cpu_};
  }

 private:
  static double cpu_now() {
    timespec t{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
  }
  std::chrono::steady_clock::time_point wall_ = std::chrono::steady_clock::now();
  double cpu_ = cpu_now();
};

/// One flat JSON object, in the order of insertion.
class JsonObject {
 public:
  JsonObject& add(const std::string& key, const std::string& value) {
    std::string quoted = "\"";
    for (const char c : value) {
      if (c == '"' || c == '\\') quoted += '\\';
      if (static_cast<unsigned char>(c) >= 0x20) quoted += c;
    }
    return add_raw(key, quoted + '"');
  }
  JsonObject& add(const std::string& key, double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", value);
    return add_raw(key, std::isfinite(value) ? text : "null");
  }
  JsonObject& add(const std::string& key, std::uint64_t value) {
    return add_raw(key, std::to_string(value));
  }
  JsonObject& add_raw(const std::string& key, const std::string& json) {
    text_ += (text_.empty() ? "\"" : ", \"") + key + "\": " + json;
    return *this;
  }
  [[nodiscard]] std::string text() const { return "{" + text_ + "}"; }

 private:
  std::string text_;
};

inline std::string json_list(const std::vector<JsonObject>& objects) {
  std::string text = "[";
  for (const JsonObject& object : objects) {
    text += (text.size() == 1 ? "\n  " : ",\n  ") + object.text();
  }
  return text + "\n]";
}

inline std::string cpu_model() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    const auto colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown";
}

/// What a figure depends on besides the code.
inline JsonObject conditions(std::string_view benchmark, int threads, std::uint64_t seed) {
  JsonObject object;
  object.add("benchmark", std::string(benchmark))
      .add("compiler", std::string("gcc-compatible ") + __VERSION__)
      .add("flags", std::string(RAYKILN_BENCH_FLAGS))
      .add("cpu", cpu_model())
      .add("threads", static_cast<std::uint64_t>(threads))
      .add("seed", seed)
      .add("tree_version", static_cast<std::uint64_t>(render::kKdTreeVersion));
  return object;
}

inline bool write_file(const std::string& path, const std::string& text) {
  std::ofstream out(path);
  out << text << '\n';
  return out.good();
}

/// Houses on a square grid: n / 12 boxes of two heights and more.
inline test::TestMesh city(std::size_t n, std::uint64_t seed) {
  test::TestMesh mesh;
  test::TestRandom random(seed);
  const auto side = static_cast<std::uint32_t>(std::lround(std::sqrt(static_cast<double>(n) / 12)));
  for (std::uint32_t house = 0; house < side * side; ++house) {
    test::TestMesh box = test::box_room(1, 0.5F);
    const float tall = random.uniform(0.5F, random.below(8) == 0 ? 8.0F : 2.0F);
    const render::Vec3f size(random.uniform(0.4F, 0.9F), random.uniform(0.4F, 0.9F), tall);
    const render::Vec3f at(static_cast<float>(house % side), static_cast<float>(house / side), 0.0F);
    for (auto& p : box.positions) p = at + (p + render::Vec3f(0.0F, 0.0F, 0.5F)) * size;
    mesh.append(std::move(box));
  }
  return mesh;
}

/// Floor and two walls, open to the camera, with twelve finely tessellated balls: small triangles
/// beside large ones.
inline test::TestMesh room(std::size_t n, std::uint64_t seed) {
  test::TestMesh mesh = test::coplanar_grid(4, 0, -1.0F);
  mesh.append(test::coplanar_grid(4, 1, 1.0F));
  mesh.append(test::coplanar_grid(4, 2, -1.0F));
  test::TestRandom random(seed);
  const auto side = static_cast<std::uint32_t>(std::lround(std::sqrt(static_cast<double>(n) / 24)));
  for (int ball = 0; ball < 12; ++ball) {
    const float radius = random.uniform(0.08F, 0.3F);
    mesh.append(test::sphere(side, side + 1, random.in_box(-0.7F, 0.7F), radius));
  }
  return mesh;
}

/// Corners and faces of a Wavefront file; faces become fans, everything else is left out.
inline std::optional<test::TestMesh> read_obj(const std::string& path) {
  std::ifstream in(path);
  if (!in) return std::nullopt;
  test::TestMesh mesh;
  std::string word;
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    words >> word;
    if (word == "v") {
      render::Vec3f p(0.0F);
      words >> p.x >> p.y >> p.z;
      mesh.positions.push_back(p);
    } else if (word == "f") {
      std::vector<std::uint32_t> face;
      while (words >> word) {
        const long i = std::strtol(word.c_str(), nullptr, 10);
        const auto count = static_cast<long>(mesh.positions.size());
        if (i == 0 || i > count || -i > count) return std::nullopt;
        face.push_back(static_cast<std::uint32_t>(i > 0 ? i - 1 : count + i));
      }
      for (std::size_t c = 2; c < face.size(); ++c) {
        mesh.triangles.push_back({face[0], face[c - 1], face[c]});
      }
    }
    word.clear();
  }
  return mesh;
}

/// About n triangles of a family, or those of a file; empty for an unknown name.
inline std::optional<test::TestMesh> make_mesh(std::string_view family, std::size_t n,
                                               std::uint64_t seed) {
  const auto side = static_cast<std::uint32_t>(std::lround(std::sqrt(static_cast<double>(n) / 2)));
  if (family == "terrain") return test::terrain(side, seed);
  if (family == "soup") return test::soup(n, seed);
  if (family == "slivers") return test::slivers(n, seed);
  if (family == "sphere") return test::sphere(side, side + 1);
  if (family == "hair") return test::hair(static_cast<std::uint32_t>(n / 32), 16, seed);
  if (family == "city") return city(n, seed);
  if (family == "room") return room(n, seed);
  if (family.ends_with(".obj")) return read_obj(std::string(family));
  return std::nullopt;
}

inline constexpr const char* kFamilies =
    "terrain, soup, slivers, sphere, hair, city, room, or a file *.obj";

}  // namespace raykiln::bench
