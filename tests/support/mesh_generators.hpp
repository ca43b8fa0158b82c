// Deterministic meshes and random numbers for tests and benchmarks: the same bytes on every
// machine (integers and correctly rounded float operations decide everything that matters).
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

#include "raykiln/accel/kdtree.hpp"

namespace raykiln::test {

using render::Vec3f;

/// SplitMix64 (Steele, Lea & Flood 2014): small, seedable, good enough to make inputs.
class TestRandom {
 public:
  explicit TestRandom(std::uint64_t seed) : state_(seed) {}
  std::uint64_t bits() {
    std::uint64_t z = (state_ += 0x9E3779B97F4A7C15ULL);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
    return z ^ (z >> 31);
  }
  /// Uniform in [0, n).
  std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>(bits() % n); }
  /// Uniform in [lo, hi).
  float uniform(float lo = 0.0F, float hi = 1.0F) {
    return lo + (hi - lo) * (static_cast<float>(bits() >> 40) * 0x1p-24F);
  }
  Vec3f in_box(float lo, float hi) {
    const float x = uniform(lo, hi);
    const float y = uniform(lo, hi);
    return {x, y, uniform(lo, hi)};
  }
  Vec3f direction() {
    for (;;) {
      const Vec3f d = in_box(-1.0F, 1.0F);
      const float length2 = render::dot(d, d);
      if (length2 > 1e-4F && length2 <= 1.0F) return d / std::sqrt(length2);
    }
  }

 private:
  std::uint64_t state_;
};

/// A mesh that owns its arrays.
struct TestMesh {
  std::vector<Vec3f> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;

  [[nodiscard]] render::TriangleView view() const { return {positions, triangles, {}}; }
  [[nodiscard]] std::array<Vec3f, 3> corners(std::size_t i) const {
    const auto& t = triangles[i];
    return {positions[t[0]], positions[t[1]], positions[t[2]]};
  }
  void add(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
    const auto n = static_cast<std::uint32_t>(positions.size());
    positions.insert(positions.end(), {a, b, c});
    triangles.push_back({n, n + 1, n + 2});
  }
  void append(TestMesh other) {  // a copy: a mesh may be appended to itself
    const auto n = static_cast<std::uint32_t>(positions.size());
    positions.insert(positions.end(), other.positions.begin(), other.positions.end());
    for (const auto& t : other.triangles) triangles.push_back({t[0] + n, t[1] + n, t[2] + n});
  }
};

namespace detail {

/// Two triangles a cell of a grid of (nu + 1) x (nv + 1) points that begins at `first`.
inline void add_grid_faces(TestMesh& mesh, std::uint32_t first, std::uint32_t nu,
                           std::uint32_t nv) {
  for (std::uint32_t v = 0; v < nv; ++v) {
    for (std::uint32_t u = 0; u < nu; ++u) {
      const std::uint32_t a = first + v * (nu + 1) + u;
      mesh.triangles.push_back({a, a + 1, a + nu + 2});
      mesh.triangles.push_back({a, a + nu + 2, a + nu + 1});
    }
  }
}

/// Value noise in [0, 1) on the integer lattice.
inline float lattice(std::uint32_t x, std::uint32_t y, std::uint64_t seed) {
  TestRandom random(seed ^ (std::uint64_t{x} << 32 | y));
  return random.uniform();
}

inline float smooth_noise(float x, float y, std::uint64_t seed) {
  const auto ix = static_cast<std::uint32_t>(x);
  const auto iy = static_cast<std::uint32_t>(y);
  const float fx = x - static_cast<float>(ix);
  const float fy = y - static_cast<float>(iy);
  const float sx = fx * fx * (3.0F - 2.0F * fx);
  const float sy = fy * fy * (3.0F - 2.0F * fy);
  const float low = lattice(ix, iy, seed) * (1.0F - sx) + lattice(ix + 1, iy, seed) * sx;
  const float high = lattice(ix, iy + 1, seed) * (1.0F - sx) + lattice(ix + 1, iy + 1, seed) * sx;
  return low * (1.0F - sy) + high * sy;
}

}  // namespace detail

/// Height field over the unit square: n x n cells, 2 n^2 triangles, eight octaves of value noise.
inline TestMesh terrain(std::uint32_t n, std::uint64_t seed = 1) {
  TestMesh mesh;
  mesh.positions.reserve(std::size_t{n + 1} * (n + 1));
  for (std::uint32_t j = 0; j <= n; ++j) {
    for (std::uint32_t i = 0; i <= n; ++i) {
      const float x = static_cast<float>(i) / static_cast<float>(n);
      const float y = static_cast<float>(j) / static_cast<float>(n);
      float height = 0.0F;
      float scale = 4.0F;
      for (std::uint64_t octave = 0; octave < 8; ++octave, scale *= 2.0F) {
        height += detail::smooth_noise(x * scale, y * scale, seed * 977 + octave) / scale;
      }
      mesh.positions.emplace_back(x, y, height);
    }
  }
  detail::add_grid_faces(mesh, 0, n, n);
  return mesh;
}

/// n unrelated triangles in the unit cube whose edges shrink like n^(-1/3), so that a cell of the
/// same number of triangles looks the same at every n.
inline TestMesh soup(std::size_t n, std::uint64_t seed = 1, float edge = 1.0F) {
  TestMesh mesh;
  TestRandom random(seed);
  const float size = edge / std::cbrt(static_cast<float>(n));
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3f p = random.in_box(0.0F, 1.0F);
    const Vec3f q = p + size * random.in_box(-1.0F, 1.0F);
    mesh.add(p, q, p + size * random.in_box(-1.0F, 1.0F));
  }
  return mesh;
}

/// n long thin triangles through the unit cube in random directions, `width` wide: the worst case
/// of every scheme that cuts space or boxes.
inline TestMesh slivers(std::size_t n, std::uint64_t seed = 1, float width = 1e-3F) {
  TestMesh mesh;
  TestRandom random(seed);
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3f p = random.in_box(0.0F, 1.0F);
    const Vec3f along = random.direction();
    mesh.add(p, p + along, p + along * 0.5F + width * random.direction());
  }
  return mesh;
}

/// Closed sphere of latitude and longitude with one vertex at each pole: 2 nu (nv - 1) triangles.
inline TestMesh sphere(std::uint32_t nu, std::uint32_t nv, Vec3f centre = Vec3f(0.0F),
                       float radius = 1.0F) {
  TestMesh mesh;
  const auto turn = 2.0 * std::numbers::pi;
  mesh.positions.push_back(centre + Vec3f(0.0F, 0.0F, radius));
  for (std::uint32_t j = 1; j < nv; ++j) {
    const double theta = std::numbers::pi * j / nv;
    for (std::uint32_t i = 0; i < nu; ++i) {
      const double phi = turn * i / nu;
      mesh.positions.push_back(centre +
                               radius * Vec3f(static_cast<float>(std::sin(theta) * std::cos(phi)),
                                              static_cast<float>(std::sin(theta) * std::sin(phi)),
                                              static_cast<float>(std::cos(theta))));
    }
  }
  mesh.positions.push_back(centre - Vec3f(0.0F, 0.0F, radius));
  const auto south = static_cast<std::uint32_t>(mesh.positions.size() - 1);
  for (std::uint32_t i = 0; i < nu; ++i) {
    const std::uint32_t next = (i + 1) % nu;
    mesh.triangles.push_back({0, 1 + i, 1 + next});
    for (std::uint32_t j = 0; j + 2 < nv; ++j) {
      const std::uint32_t a = 1 + j * nu;
      mesh.triangles.push_back({a + i, a + nu + i, a + nu + next});
      mesh.triangles.push_back({a + i, a + nu + next, a + next});
    }
    const std::uint32_t last = 1 + (nv - 2) * nu;
    mesh.triangles.push_back({last + i, south, last + next});
  }
  return mesh;
}

/// n x n quads of the square [-half, half]^2 in the plane axis = at: all triangles coplanar.
inline TestMesh coplanar_grid(std::uint32_t n, int axis = 2, float at = 0.0F, float half = 1.0F) {
  TestMesh mesh;
  for (std::uint32_t j = 0; j <= n; ++j) {
    for (std::uint32_t i = 0; i <= n; ++i) {
      Vec3f p(at);
      p[(axis + 1) % 3] = half * (2.0F * static_cast<float>(i) / static_cast<float>(n) - 1.0F);
      p[(axis + 2) % 3] = half * (2.0F * static_cast<float>(j) / static_cast<float>(n) - 1.0F);
      mesh.positions.push_back(p);
    }
  }
  detail::add_grid_faces(mesh, 0, n, n);
  return mesh;
}

/// A closed axis-aligned box [-half, half]^3 whose six walls are grids of n x n quads.
inline TestMesh box_room(std::uint32_t n, float half = 1.0F) {
  TestMesh mesh;
  for (int axis = 0; axis < 3; ++axis) {
    mesh.append(coplanar_grid(n, axis, -half, half));
    mesh.append(coplanar_grid(n, axis, half, half));
  }
  return mesh;
}

/// `strands` curved ribbons of `pieces` quads standing on the unit square, `width` wide.
inline TestMesh hair(std::uint32_t strands, std::uint32_t pieces, std::uint64_t seed = 1,
                     float width = 1e-3F) {
  TestMesh mesh;
  TestRandom random(seed);
  for (std::uint32_t s = 0; s < strands; ++s) {
    Vec3f p(random.uniform(), random.uniform(), 0.0F);
    const Vec3f bend = 0.3F * random.in_box(-1.0F, 1.0F);
    const Vec3f side = width * random.direction();
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (std::uint32_t i = 0; i <= pieces; ++i) {
      const float h = static_cast<float>(i) / static_cast<float>(pieces);
      const Vec3f q = p + Vec3f(bend.x * h * h, bend.y * h * h, (0.6F + bend.z) * h);
      mesh.positions.push_back(q);
      mesh.positions.push_back(q + side);
    }
    detail::add_grid_faces(mesh, first, 1, pieces);
  }
  return mesh;
}

/// n copies of one oblique triangle.
inline TestMesh identical_triangles(std::size_t n) {
  TestMesh mesh;
  mesh.positions = {{1.0F, 0.0F, 0.0F}, {0.0F, 1.0F, 0.0F}, {0.0F, 0.0F, 1.0F}};
  mesh.triangles.assign(n, {0U, 1U, 2U});
  return mesh;
}

/// The same triangles in another order; `order` receives the old id of each new one if not null.
inline TestMesh shuffled(const TestMesh& mesh, std::uint64_t seed,
                         std::vector<std::uint32_t>* order = nullptr) {
  TestMesh result = mesh;
  std::vector<std::uint32_t> old(mesh.triangles.size());
  for (std::size_t i = 0; i < old.size(); ++i) old[i] = static_cast<std::uint32_t>(i);
  TestRandom random(seed);
  for (std::size_t i = old.size(); i > 1; --i) {
    std::swap(old[i - 1], old[random.below(static_cast<std::uint32_t>(i))]);
  }
  for (std::size_t i = 0; i < old.size(); ++i) result.triangles[i] = mesh.triangles[old[i]];
  if (order != nullptr) *order = std::move(old);
  return result;
}

}  // namespace raykiln::test
