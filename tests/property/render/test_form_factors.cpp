// Light from area emitters against form factors in closed form.
#include <gtest/gtest.h>

#include "raykiln/sampling/warp.hpp"
#include "support/scene_pieces.hpp"

namespace raykiln::render {
namespace {

using support::diffuse_material;
using support::Estimate;
using support::SceneBuilder;

/// From a point to the parallel unit square centred at height h above it: four times the corner
/// formula with sides 1/2 (Howell's catalogue of configuration factors, B-3).
double point_to_square(double h) {
  const double x = 0.5 / h, root = std::sqrt(1.0 + x * x);
  return 4.0 * (1.0 / kPi) * (x / root) * std::atan(x / root);
}

void add_square(SceneBuilder& b, float h, const Rgb& radiance) {
  b.quad({Vec3f(-0.5F, -0.5F, h), {-0.5F, 0.5F, h}, {0.5F, 0.5F, h}, {0.5F, -0.5F, h}},
         b.material(diffuse_material(Rgb(0.0F), radiance)));
}

// Radiance of the floor at the foot: albedo times L F. 6 checks at 4 sigma: false alarm 4e-4.
TEST(FormFactors, SquareLampOverAFloor) {
  for (const float h : {1.0F, 0.1F, 10.0F}) {
    SceneBuilder b;
    b.quad({Vec3f(-1, -1, 0), {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, b.material(diffuse_material(Rgb(0.8F))));
    add_square(b, h, Rgb(2.0F));
    b.camera({0.004F * h, 0.003F * h, 0.5F * h}, Vec3f(0.0F), {0, 1, 0}, 1e-4F);
    const auto scene = b.prepare();
    for (const bool emitters : {true, false}) {
      if (!emitters && h > 5.0F) continue;  // found too seldom to say anything
      RenderSettings settings;
      settings.width = settings.height = 8;
      settings.max_depth = 1;
      settings.emitter_sampling = emitters;
      const Estimate e = support::estimate(support::render_all(*scene, settings, 1024));
      const double truth = 0.8 * 2.0 * point_to_square(static_cast<double>(h));
      EXPECT_NEAR(e.mean.y, truth, 4.0 * e.standard_error + 1e-5 * truth) << h << ' ' << emitters;
      EXPECT_LT(e.standard_error, 0.02 * truth);
    }
  }
}

// Two unit squares at a right angle with a common edge, F = 0.200044: area sampling alone has
// infinite variance at the edge, the weights against the path's own rays remove it. The picture is
// exactly the receiver. 2 checks at 4 sigma: 1.3e-4.
TEST(FormFactors, SquaresThatTouch) {
  SceneBuilder b;
  b.quad({Vec3f(0, 0, 0), {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, b.material(diffuse_material(Rgb(1.0F))));
  b.quad({Vec3f(0, 0, 0), {0, 1, 0}, {0, 1, 1}, {0, 0, 1}},
         b.material(diffuse_material(Rgb(0.0F), Rgb(1.0F))));
  b.camera({0.5F, 0.5F, 2.0F}, {0.5F, 0.5F, 0.0F}, {0, 1, 0}, static_cast<float>(2.0 * std::atan(0.25)));
  const auto scene = b.prepare();
  for (const bool emitters : {true, false}) {
    RenderSettings settings;
    settings.width = settings.height = 32;
    settings.max_depth = 1;
    settings.emitter_sampling = emitters;
    const Estimate e = support::estimate(support::render_all(*scene, settings, 256));
    EXPECT_NEAR(e.mean.y, 0.200044, 4.0 * e.standard_error + 2e-5) << emitters;
    EXPECT_LT(e.standard_error, 2e-3);
  }
}

// An emitter shines to both sides: the floor below and the ceiling above see the same square.
TEST(FormFactors, EmissionIsTwoSided) {
  SceneBuilder b;
  const auto white = b.material(diffuse_material(Rgb(0.5F)));
  b.quad({Vec3f(-1, -1, -1), {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}}, white);
  b.quad({Vec3f(-1, -1, 1), {-1, 1, 1}, {1, 1, 1}, {1, -1, 1}}, white);
  add_square(b, 0.0F, Rgb(1.0F));
  RenderSettings settings;
  settings.width = settings.height = 4;
  settings.max_depth = 1;
  for (const float side : {-1.0F, 1.0F}) {
    b.scene().cameras.clear();
    b.camera({0.01F, 0.02F, 0.5F * side}, {0, 0, side}, {0, 1, 0}, 1e-4F);
    const Estimate e = support::estimate(support::render_all(*b.prepare(), settings, 1024));
    EXPECT_NEAR(e.mean.y, 0.5 * point_to_square(1.0), 4.0 * e.standard_error + 1e-6);
  }
}

// Lamp of area 1e-8 and radiance 1e8 at distance 1: E = 1, found by emitter sampling alone.
TEST(FormFactors, AVerySmallLamp) {
  SceneBuilder b;
  b.quad({Vec3f(-1, -1, 0), {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, b.material(diffuse_material(Rgb(0.5F))));
  constexpr float kHalf = 0.5e-4F;
  b.quad({Vec3f(-kHalf, -kHalf, 1), {-kHalf, kHalf, 1}, {kHalf, kHalf, 1}, {kHalf, -kHalf, 1}},
         b.material(diffuse_material(Rgb(0.0F), Rgb(1e8F))));
  b.camera({0.1F, 0.2F, 0.5F}, Vec3f(0.0F), {0, 1, 0}, 1e-4F);
  RenderSettings settings;
  settings.width = settings.height = 4;
  settings.max_depth = 1;
  const Estimate e = support::estimate(support::render_all(*b.prepare(), settings, 64));
  EXPECT_NEAR(e.mean.y, 0.5 / kPi, 4.0 * e.standard_error + 1e-4);
}

}  // namespace
}  // namespace raykiln::render
