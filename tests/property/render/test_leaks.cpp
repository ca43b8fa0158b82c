// Rays do not pass through what is closed.
#include <gtest/gtest.h>

#include "raykiln/sampling/warp.hpp"
#include "support/scene_pieces.hpp"

namespace raykiln::render {
namespace {

using support::diffuse_material;
using support::SceneBuilder;

TileResult render(const SceneBuilder& b, int side, int depth, std::uint64_t samples) {
  RenderSettings settings;
  settings.width = settings.height = side;
  settings.max_depth = depth;
  settings.light_model.roulette = false;  // all paths to the end
  return support::render_all(*b.prepare(), settings, samples);
}

double brightest(const TileResult& result) {
  double brightest = 0.0;
  for (const BlockResult& block : result.blocks) {
    for (const double x : block.planes.planes[BlockPlane::kLargest]) brightest = std::max(brightest, x);
  }
  return brightest;
}

// Two skins 1e-4 apart around a room of size 10, lamps and a point light outside: exactly dark.
TEST(Leaks, ThinWallsKeepARoomDark) {
  SceneBuilder b;
  const auto wall = b.material(diffuse_material(Rgb(0.9F)));
  b.box(Vec3f(-5.0F), Vec3f(5.0F), wall, true);
  b.box(Vec3f(-5.0001F), Vec3f(5.0001F), wall);
  b.box(Vec3f(-9.0F), Vec3f(9.0F), b.material(diffuse_material(Rgb(0.5F), Rgb(1e6F))), true);
  b.point_light({6, 7, 5.5F}, Rgb(1e9F));
  b.scene().background = Rgb(1e6F);
  b.camera({1, 2, 3}, {-5, -5, -4.9F}, {0, 1, 0}, 2.0F);
  const TileResult result = render(b, 32, 10, 32);
  EXPECT_GT(result.stats.bounce_rays, 300000U);
  EXPECT_EQ(brightest(result), 0.0);
}

/// A ball of 80 faces per octant with smooth normals, every third of them turned inside out.
void add_ball(SceneBuilder& b, std::uint32_t material, int n) {
  TriangleMesh& mesh = b.scene().mesh;
  const auto at = [&](int i, int j) {
    const double theta = kPi * i / n, phi = 2.0 * kPi * (j % n) / n;
    return Vec3f(Vec3d(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)));
  };
  const auto add = [&](const Vec3f& p, const Vec3f& q, const Vec3f& r) {
    if (length(cross(q - p, r - p)) < 1e-6F) return;
    const auto first = static_cast<std::uint32_t>(mesh.normals.size());
    b.triangle(p, q, r, material);
    for (const Vec3f& x : {p, q, r}) mesh.normals.push_back(mesh.normals.size() % 3 == 0 ? -x : x);
    mesh.corner_normals.push_back({first, first + 1, first + 2});
  };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      add(at(i, j), at(i + 1, j), at(i + 1, j + 1));
      add(at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
  }
}

TEST(Leaks, SmoothOpaqueBallKeepsItsInsideDarkAndIsNeverNegative) {
  Material gloss = support::mirror_material(0.5F, 20.0);
  gloss.diffuse = Rgb(0.4F);
  for (const bool inside : {true, false}) {
    SceneBuilder b;
    add_ball(b, b.material(gloss), 24);
    b.point_light({3, 1, 2}, Rgb(1e6F));
    b.scene().background = Rgb(10.0F);
    b.camera(inside ? Vec3f(0.1F, 0.0F, 0.2F) : Vec3f(0, 3, 0), Vec3f(0.0F), {0, 0, 1}, 1.0F);
    const TileResult result = render(b, 32, 5, 16);
    EXPECT_EQ(result.stats.non_finite, 0U);
    EXPECT_EQ(result.stats.negative, 0U);
    EXPECT_EQ(brightest(result) == 0.0, inside);
  }
}

// A plate of glass from 1e-2 down to 1e-5 thick at |p| = 1: what is seen through it is the lamp's 1,
// times (1 - F)/(1 + F). 4 sigma each: false alarm 2.5e-4.
TEST(Leaks, ThinGlassPlatesKeepBothFaces) {
  for (const float thickness : {1e-2F, 1e-3F, 1e-4F, 1e-5F}) {
    SceneBuilder b;
    const auto glass = b.material(support::glass_material(1.5F, 1e12));
    b.quad({Vec3f(-1, -1, 1), {1, -1, 1}, {1, 1, 1}, {-1, 1, 1}}, glass);
    const float z = 1.0F - thickness;
    b.quad({Vec3f(-1, -1, z), {-1, 1, z}, {1, 1, z}, {1, -1, z}}, glass);
    b.quad({Vec3f(-9, -9, -1), {9, -9, -1}, {9, 9, -1}, {-9, 9, -1}},
           b.material(diffuse_material(Rgb(0.0F), Rgb(1.0F))));
    b.camera({0, 0, 2}, Vec3f(0.0F), {0, 1, 0}, 0.01F);
    const support::Estimate e = support::estimate(render(b, 16, 40, 256));
    EXPECT_NEAR(e.mean.y, 0.96 / 1.04, 4.0 * e.standard_error + 1e-5) << thickness;
  }
}

}  // namespace
}  // namespace raykiln::render
