// Closed meshes and similarity transforms: the members of the classes of the geometric hard cases.
#pragma once

#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "raykiln/math/vec.hpp"
#include "support/mesh_generators.hpp"

namespace raykiln::hard {

using render::Vec3d;
using render::Vec3f;
using test::TestMesh;
using test::TestRandom;

/// A closed mesh and points well inside of it.
struct ClosedMesh {
  std::string name;
  TestMesh mesh;
  std::vector<Vec3f> inside;  ///< each at least 0.1 of the size away from the surface
};

/// Corner of the box [lo, hi] with bit k set where axis k is at hi.
inline Vec3f box_corner(const Vec3f& lo, const Vec3f& hi, unsigned i) {
  return {(i & 1U) != 0 ? hi.x : lo.x, (i & 2U) != 0 ? hi.y : lo.y, (i & 4U) != 0 ? hi.z : lo.z};
}

/// Twelve triangles over eight shared corners, wound outwards.
inline TestMesh cube(const Vec3f& lo, const Vec3f& hi) {
  TestMesh mesh;
  for (unsigned i = 0; i < 8; ++i) mesh.positions.push_back(box_corner(lo, hi, i));
  constexpr std::array<std::array<std::uint32_t, 4>, 6> kFaces{
      {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
  for (const auto& f : kFaces) {
    mesh.triangles.push_back({f[0], f[1], f[2]});
    mesh.triangles.push_back({f[0], f[2], f[3]});
  }
  return mesh;
}

/// Icosahedron with every triangle cut in four `levels` times: 20 * 4^levels triangles, corners of
/// valence 5 and 6, on the unit sphere.
inline TestMesh icosphere(int levels) {
  const float g = std::numbers::phi_v<float>;
  TestMesh mesh;
  mesh.positions = {{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0}, {0, -1, g}, {0, 1, g},
                    {0, -1, -g}, {0, 1, -g}, {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
  mesh.triangles = {{0, 11, 5}, {0, 5, 1}, {0, 1, 7}, {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                    {11, 10, 2}, {10, 7, 6}, {7, 1, 8}, {3, 9, 4}, {3, 4, 2}, {3, 2, 6}, {3, 6, 8},
                    {3, 8, 9}, {4, 9, 5}, {2, 4, 11}, {6, 2, 10}, {8, 6, 7}, {9, 8, 1}};
  for (Vec3f& p : mesh.positions) p = render::normalize(p);
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [at, is_new] = middles.try_emplace(std::minmax(a, b), 0U);
      if (is_new) {
        at->second = static_cast<std::uint32_t>(mesh.positions.size());
        mesh.positions.push_back(render::normalize(mesh.positions[a] + mesh.positions[b]));
      }
      return at->second;
    };
    std::vector<std::array<std::uint32_t, 3>> finer;
    for (const auto& t : mesh.triangles) {
      const std::uint32_t ab = middle(t[0], t[1]);
      const std::uint32_t bc = middle(t[1], t[2]);
      const std::uint32_t ca = middle(t[2], t[0]);
      finer.insert(finer.end(), {{t[0], ab, ca}, {ab, t[1], bc}, {ca, bc, t[2]}, {ab, bc, ca}});
    }
    mesh.triangles = std::move(finer);
  }
  return mesh;
}

/// Ring of radius 1 about z with a tube of radius `tube`: 2 nu nv triangles.
inline TestMesh torus(std::uint32_t nu, std::uint32_t nv, double tube) {
  TestMesh mesh;
  for (std::uint32_t i = 0; i < nu; ++i) {
    const double a = 2.0 * std::numbers::pi * i / nu;
    for (std::uint32_t j = 0; j < nv; ++j) {
      const double b = 2.0 * std::numbers::pi * j / nv;
      const double r = 1.0 + tube * std::cos(b);
      mesh.positions.emplace_back(Vec3d(r * std::cos(a), r * std::sin(a), tube * std::sin(b)));
    }
  }
  for (std::uint32_t i = 0; i < nu; ++i) {
    for (std::uint32_t j = 0; j < nv; ++j) {
      const std::uint32_t i1 = (i + 1) % nu;
      const std::uint32_t j1 = (j + 1) % nv;
      mesh.triangles.push_back({i * nv + j, i1 * nv + j, i1 * nv + j1});
      mesh.triangles.push_back({i * nv + j, i1 * nv + j1, i * nv + j1});
    }
  }
  return mesh;
}

/// Two cones over a ring of n random points: the two apexes have valence n, the ring valence 4.
inline TestMesh bipyramid(std::uint32_t n, TestRandom& random) {
  TestMesh mesh;
  mesh.positions = {{0.0F, 0.0F, 1.0F}, {0.0F, 0.0F, -1.0F}};
  for (std::uint32_t i = 0; i < n; ++i) {
    const double a = 2.0 * std::numbers::pi * (i + 0.5 * static_cast<double>(random.uniform())) / n;
    mesh.positions.emplace_back(
        Vec3d(std::cos(a), std::sin(a), static_cast<double>(random.uniform(-0.2F, 0.2F))));
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    mesh.triangles.push_back({0, 2 + i, 2 + (i + 1) % n});
    mesh.triangles.push_back({1, 2 + (i + 1) % n, 2 + i});
  }
  return mesh;
}

/// p -> scale * (rotation p) + shift, computed in double.
struct Similarity {
  std::array<Vec3d, 3> columns{Vec3d(1, 0, 0), Vec3d(0, 1, 0), Vec3d(0, 0, 1)};
  double scale = 1.0;
  Vec3d shift{0.0};

  [[nodiscard]] Vec3f operator()(const Vec3f& p) const {
    const Vec3d turned = columns[0] * static_cast<double>(p.x) +
                         columns[1] * static_cast<double>(p.y) +
                         columns[2] * static_cast<double>(p.z);
    return Vec3f(scale * turned + shift);
  }
};

inline Similarity random_rotation(TestRandom& random) {
  const Vec3d x = render::normalize(Vec3d(random.direction()));
  Vec3d y(0.0);
  do {
    y = Vec3d(random.direction());
    y -= render::dot(x, y) * x;
  } while (render::dot(y, y) < 0.01);
  y = render::normalize(y);
  Similarity s;
  s.columns = {x, y, render::cross(x, y)};
  return s;
}

/// Turned at random, scaled by 10^U(-4, 4) and moved by up to `offset` of its size.
inline Similarity random_similarity(TestRandom& random, double offset) {
  Similarity s = random_rotation(random);
  s.scale = std::pow(10.0, static_cast<double>(random.uniform(-4.0F, 4.0F)));
  s.shift = s.scale * offset * Vec3d(random.in_box(-1.0F, 1.0F));
  return s;
}

inline void apply(const Similarity& s, TestMesh& mesh) {
  for (Vec3f& p : mesh.positions) p = s(p);
}
inline ClosedMesh apply(const Similarity& s, ClosedMesh closed) {
  apply(s, closed.mesh);
  for (Vec3f& p : closed.inside) p = s(p);
  return closed;
}

inline std::vector<Vec3f> points_in_ball(TestRandom& random, double radius, std::size_t n) {
  std::vector<Vec3f> points;
  for (std::size_t i = 0; i < n; ++i) {
    points.push_back(random.direction() * (static_cast<float>(radius) * random.uniform()));
  }
  return points;
}

/// The closed meshes of V03 and V04: cube, icosphere and torus of 20 000 triangles, and bipyramids
/// with apexes of valence 3 to 8.
inline std::vector<ClosedMesh> closed_meshes(TestRandom& random) {
  std::vector<ClosedMesh> meshes;
  meshes.push_back({"cube", cube(Vec3f(-1.0F), Vec3f(1.0F)), points_in_ball(random, 0.8, 256)});
  meshes.push_back({"icosphere", icosphere(5), points_in_ball(random, 0.8, 256)});
  ClosedMesh ring{"torus", torus(200, 50, 0.4), {}};
  for (int i = 0; i < 256; ++i) {
    const float a = random.uniform(0.0F, 2.0F * std::numbers::pi_v<float>);
    ring.inside.push_back(Vec3f(std::cos(a), std::sin(a), 0.0F) +
                          random.direction() * random.uniform(0.0F, 0.25F));
  }
  meshes.push_back(std::move(ring));
  for (std::uint32_t n = 3; n <= 8; ++n) {
    meshes.push_back({"bipyramid" + std::to_string(n), bipyramid(n, random),
                      points_in_ball(random, 0.15, 256)});
  }
  return meshes;
}

}  // namespace raykiln::hard
