// The meshes of the benchmarks, by name. The scenes of the list are frozen: generator, size and
// seed never change, so that figures of different days and programs speak of the same triangles.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "support/mesh_generators.hpp"

namespace raykiln::bench {

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
  if (family == "sliver" || family == "slivers") return test::slivers(n, seed);
  if (family == "sphere") return test::sphere(side, side + 1);
  if (family == "hair") return test::hair(static_cast<std::uint32_t>(n / 32), 16, seed);
  if (family == "city") return city(n, seed);
  if (family == "room") return room(n, seed);
  if (family.ends_with(".obj")) return read_obj(std::string(family));
  return std::nullopt;
}

inline constexpr const char* kFamilies =
    "terrain, soup, sliver, sphere, hair, city, room, or a file *.obj";

/// A scene of the comparisons: family, size and seed as make_mesh takes them.
struct BenchScene {
  const char* name;
  const char* family;
  std::size_t triangles;
  std::uint64_t seed;
  std::uint64_t hash;  ///< mesh_hash of what comes out; 0: not checked
};

/// Scans lie in build/models, put there by fetch_bunny.mjs and tests/support/fetch_dragon.mjs; the
/// rest is made here.
inline constexpr BenchScene kBenchScenes[] = {
    {"bunny", "build/models/bunny.obj", 0, 0, 0},
    {"dragon", "build/models/dragon-1.obj", 0, 0, 0},
    {"room", "room", 400'000, 1, 0xB2061721303DEF5FULL},
    {"city", "city", 1'200'000, 1, 0x24AA3435F6B68ECDULL},
    {"terrain", "terrain", 1'000'000, 1, 0xBE69B93BF8DE611FULL},
    {"terrain8m", "terrain", 8'000'000, 1, 0},
    {"soup", "soup", 1'000'000, 1, 0x842BAEC31D4A602EULL},
    {"sliver", "sliver", 100'000, 1, 0x1F4E491F81A6E791ULL},
};

[[nodiscard]] inline const BenchScene* find_bench_scene(std::string_view name) {
  for (const BenchScene& scene : kBenchScenes) {
    if (name == scene.name) return &scene;
  }
  return nullptr;
}

/// FNV-1a over the words of positions and triangles: names a mesh in a report.
[[nodiscard]] inline std::uint64_t mesh_hash(const test::TestMesh& mesh) {
  std::uint64_t hash = 0xCBF29CE484222325ULL;
  const auto add = [&](std::uint32_t word) { hash = (hash ^ word) * 0x100000001B3ULL; };
  for (const render::Vec3f& p : mesh.positions) {
    for (int axis = 0; axis < 3; ++axis) add(std::bit_cast<std::uint32_t>(p[axis]));
  }
  for (const auto& t : mesh.triangles) {
    for (const std::uint32_t corner : t) add(corner);
  }
  return hash;
}

}  // namespace raykiln::bench
