// Point lights: closed forms, shadows, and the places where they must not shine.
#include <gtest/gtest.h>

#include "raykiln/sampling/warp.hpp"
#include "raykiln/shading/emitters.hpp"
#include "support/scene_pieces.hpp"

namespace raykiln::render {
namespace {

using support::diffuse_material;
using support::SceneBuilder;

constexpr float kTiny = 1e-5F;  ///< field of view that sees one point

/// Radiance of the floor point under `target`, seen from above and a little aside.
double radiance_at(SceneBuilder& b, const Vec3f& target, int depth = 0, std::uint64_t samples = 1) {
  b.scene().cameras.clear();
  b.camera(target + Vec3f(0.7F, 0.4F, 1.5F), target, {0, 1, 0}, kTiny);
  RenderSettings settings;
  settings.width = settings.height = 1;
  settings.max_depth = depth;
  const TileResult result = support::render_all(*b.prepare(), settings, samples);
  EXPECT_EQ(result.stats.non_finite, 0U);
  return support::estimate(result).mean.x;
}

SceneBuilder floor_of(float albedo, float side = 10.0F) {
  SceneBuilder b;
  b.quad({Vec3f(-side, -side, 0), {side, -side, 0}, {side, side, 0}, {-side, side, 0}},
         b.material(diffuse_material(Rgb(albedo))));
  return b;
}

TEST(Emitters, HaveNoTableWhereNothingShines) {
  SceneBuilder b = floor_of(0.8F);
  b.point_light({0, 0, 2}, Rgb(0.0F));
  EXPECT_EQ(Emitters(b.scene()).bytes(), 0U);
  b.point_light({0, 0, 2}, Rgb(1.0F));
  EXPECT_GE(Emitters(b.scene()).bytes(), sizeof(PointLight));
}

// L = (a/pi) I h / (h^2 + r^2)^(3/2).
TEST(PointLights, IrradianceOfAPlane) {
  SceneBuilder b = floor_of(0.8F);
  b.point_light({0, 0, 2}, Rgb(10.0F));
  for (const float r : {0.0F, 1.0F, 3.0F}) {
    const double d2 = 4.0 + static_cast<double>(r) * static_cast<double>(r);
    const double truth = 0.8 / kPi * 10.0 * 2.0 / std::pow(d2, 1.5);
    EXPECT_NEAR(radiance_at(b, {r, 0, 0}), truth, 1e-5 * truth) << r;
  }
}

// At a height of 1e-10 the square of the distance is 1e-20; nothing overflows.
TEST(PointLights, InverseSquareNearTheSurface) {
  for (const float h : {1.0F, 1e-3F}) {
    SceneBuilder b = floor_of(0.5F);
    b.point_light({0, 0, h}, Rgb(1.0F));
    const double truth = 0.5 / kPi / (static_cast<double>(h) * static_cast<double>(h));
    // The pixel has a width of 2e-5: beside the foot the light already falls off at h = 1e-3.
    EXPECT_NEAR(radiance_at(b, Vec3f(0.0F)), truth, 1e-3 * truth) << h;
  }
}

TEST(PointLights, GlassAndWallsStopTheirRays) {
  for (const bool glass : {true, false}) {
    SceneBuilder b = floor_of(0.8F);
    const auto pane = b.material(glass ? support::glass_material(1.5F, 1e10) : diffuse_material(Rgb(0.5F)));
    b.quad({Vec3f(-0.3F, -0.3F, 1), {0.3F, -0.3F, 1}, {0.3F, 0.3F, 1}, {-0.3F, 0.3F, 1}}, pane);
    b.point_light({0, 0, 2}, Rgb(10.0F));
    EXPECT_EQ(radiance_at(b, {0.1F, 0.2F, 0.0F}), 0.0);
    EXPECT_GT(radiance_at(b, {3.0F, 0.0F, 0.0F}), 0.0);
  }
}

// Occluders near either end of the way stop the ray; a wall just behind the light does not.
TEST(PointLights, EndsOfShadowRays) {
  for (const float distance : {1.0F, 1e3F, 1e6F}) {
    for (const float at : {1e-5F, 0.5F, 1.0F - 1e-5F, 1.0F + 1e-6F}) {
      SceneBuilder b = floor_of(0.8F, 4.0F * distance);
      const float z = at * distance, s = 3.0F * distance;
      b.quad({Vec3f(-s, -s, z), {s, -s, z}, {s, s, z}, {-s, s, z}},
             b.material(diffuse_material(Rgb(0.0F))));
      b.point_light({0, 0, distance}, Rgb(distance * distance));
      // Seen from between floor and occluder.
      b.camera({0.02F * z, 0.01F * z, 0.5F * std::min(z, distance)}, Vec3f(0.0F), {0, 1, 0}, kTiny);
      RenderSettings settings;
      settings.width = settings.height = 16;
      settings.max_depth = 0;
      const TileResult result = support::render_all(*b.prepare(), settings, 1);
      Film film(16, 16);
      merge(film, result);
      for (const float value : film.resolve().rgb) {
        if (at < 1.0F) {
          ASSERT_EQ(value, 0.0F) << distance << ' ' << at;
        } else {
          ASSERT_GT(value, 0.0F) << distance << ' ' << at;
        }
      }
    }
  }
}

// A light exactly in the plane of the ceiling lights all of the floor and none of the ceiling.
TEST(PointLights, InThePlaneOfACeiling) {
  SceneBuilder b;
  const auto white = b.material(diffuse_material(Rgb(0.8F)));
  b.quad({Vec3f(-1, -1, 0), {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, white);
  b.quad({Vec3f(-1, -1, 2), {-1, 1, 2}, {1, 1, 2}, {1, -1, 2}}, white);
  b.point_light({0.123F, 0.217F, 2}, Rgb(1.0F));
  RenderSettings settings;
  settings.width = settings.height = 32;
  settings.max_depth = 0;
  b.camera({0, 0, 1}, {0, 0, 0}, {0, 1, 0}, 1.4F);
  const auto see = [&] {
    Film film(32, 32);
    merge(film, support::render_all(*b.prepare(), settings, 4));
    return film.resolve().rgb;
  };
  for (const float value : see()) ASSERT_GT(value, 0.0F);
  b.scene().cameras.clear();
  b.camera({0, 0, 1}, {0, 0, 2}, {0, 1, 0}, 1.4F);
  for (const float value : see()) ASSERT_EQ(value, 0.0F);
}

TEST(PointLights, AtTheCameraAndAtAVertexStayFinite) {
  SceneBuilder b = floor_of(0.5F);
  b.point_light({0, 0, 2}, Rgb(4.0F));
  b.camera({0, 0, 2}, Vec3f(0.0F), {0, 1, 0}, kTiny);
  RenderSettings settings;
  settings.width = settings.height = 1;
  settings.max_depth = 0;
  EXPECT_NEAR(support::estimate(support::render_all(*b.prepare(), settings, 4)).mean.x, 0.5 / kPi, 1e-6);
  b.point_light({-10, -10, 0}, Rgb(4.0F));  // a corner of the floor
  const TileResult result = support::render_all(*b.prepare(), settings, 4);
  EXPECT_EQ(result.stats.non_finite, 0U);
}

TEST(PointLights, AddUpAndZeroOnesCostNothing) {
  SceneBuilder both = floor_of(0.8F), first = floor_of(0.8F), second = floor_of(0.8F);
  first.point_light({1, 0, 2}, Rgb(3.0F));
  second.point_light({0, 2, 1}, {0.0F, 5.0F, 1.0F});
  both.point_light({1, 0, 2}, Rgb(3.0F));
  both.point_light({0, 2, 1}, {0.0F, 5.0F, 1.0F});
  for (int i = 0; i < 1000; ++i) both.point_light({0, 0, 1}, Rgb(0.0F));
  RenderSettings settings;
  settings.width = settings.height = 16;
  settings.max_depth = 0;
  const auto render = [&](SceneBuilder& b, std::uint64_t shadow_rays) {
    b.camera({1, 1, 3}, Vec3f(0.0F), {0, 1, 0}, 0.8F);
    const TileResult result = support::render_all(*b.prepare(), settings, 1);
    EXPECT_EQ(result.stats.shadow_rays, shadow_rays);
    Film film(16, 16);
    merge(film, result);
    return film.plane("beauty");
  };
  const auto a = render(first, 256), b = render(second, 256), sum = render(both, 512);
  for (std::size_t i = 0; i < sum.size(); ++i) ASSERT_NEAR(sum[i], a[i] + b[i], 1e-15 * sum[i]);
}

// More lights than a queue of shadow rays holds.
TEST(PointLights, ManyLightsAreTracedInPieces) {
  SceneBuilder b = floor_of(0.8F);
  for (int i = 0; i < 20000; ++i) b.point_light({0, 0, 2}, Rgb(10.0F / 20000.0F));
  const double truth = 0.8 / kPi * 10.0 / 4.0;
  EXPECT_NEAR(radiance_at(b, Vec3f(0.0F)), truth, 1e-5 * truth);
}

}  // namespace
}  // namespace raykiln::render
