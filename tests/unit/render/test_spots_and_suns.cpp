// Spots and directional lights: closed forms, shadows, and the places where they must not shine.
#include <gtest/gtest.h>

#include "raykiln/sampling/warp.hpp"
#include "support/scene_pieces.hpp"

namespace raykiln::render {
namespace {

using support::diffuse_material;
using support::SceneBuilder;

constexpr float kTiny = 1e-5F;  ///< field of view that sees one point
constexpr double kAlbedo = 0.8;

SceneBuilder floor_of(float side = 10.0F) {
  SceneBuilder b;
  b.quad({Vec3f(-side, -side, 0), {side, -side, 0}, {side, side, 0}, {-side, side, 0}},
         b.material(diffuse_material(Rgb(static_cast<float>(kAlbedo)))));
  return b;
}

/// Irradiance of a floor point, from its radiance seen from above and a little aside.
double irradiance_at(SceneBuilder b, const Vec3f& target) {
  b.scene().cameras.clear();
  b.camera(target + Vec3f(0.7F, 0.4F, 1.5F), target, {0, 1, 0}, kTiny);
  RenderSettings settings;
  settings.width = settings.height = 1;
  settings.max_depth = 0;
  const TileResult result = support::render_all(*b.prepare(), settings, 1);
  EXPECT_EQ(result.stats.non_finite, 0U);
  return support::estimate(result).mean.x * kPi / kAlbedo;
}

SpotLight spot_at(const Vec3f& position, const Vec3d& axis, double inner, double outer) {
  SpotLight light;
  light.position = position;
  light.axis = normalize(axis);
  light.intensity = Rgb(10.0F);
  light.inner_one_minus_cos = 1.0 - std::cos(inner);
  light.outer_one_minus_cos = 1.0 - std::cos(outer);
  return light;
}

// E = I h / d^3 times 1 within the inner cone, the squared ramp between, 0 outside.
TEST(SpotLights, IrradianceAcrossTheCones) {
  SceneBuilder b = floor_of();
  b.scene().spot_lights.push_back(spot_at({0, 0, 2}, {0, 0, -1}, 0.3, 0.8));
  for (const double angle : {0.0, 0.2, 0.29, 0.4, 0.6, 0.79, 0.81, 1.2}) {
    const double d = 2.0 / std::cos(angle);
    const double ramp =
        (std::cos(angle) - std::cos(0.8)) / (std::cos(0.3) - std::cos(0.8));
    const double share = angle < 0.3 ? 1.0 : angle > 0.8 ? 0.0 : ramp * ramp;
    const double truth = 10.0 * 2.0 / (d * d * d) * share;
    const auto r = static_cast<float>(2.0 * std::tan(angle));
    EXPECT_NEAR(irradiance_at(b, {r, 0, 0}), truth, 2e-5 * truth + 1e-6 * (share < 1.0)) << angle;
  }
}

// Flux: 2 pi I [1 - cos i + (cos i - cos o)/3]; all of it lands on the floor. 4 sigma.
TEST(SpotLights, FluxOnTheFloor) {
  SceneBuilder b = floor_of(4.0F);
  b.scene().spot_lights.push_back(spot_at({0.3F, 0.2F, 2}, {0.1, -0.2, -1.0}, 0.3, 0.7));
  const double flux =
      2.0 * kPi * 10.0 * (1.0 - std::cos(0.3) + (std::cos(0.3) - std::cos(0.7)) / 3.0);
  b.camera({0, 0, 1e4}, Vec3f(0.0F), {0, 1, 0}, 2.0 * std::atan(4e-4));
  RenderSettings settings;
  settings.width = settings.height = 64;
  settings.max_depth = 0;
  const support::Estimate e =
      support::estimate(support::render_all(*b.prepare(), settings, 16));
  const double truth = kAlbedo / kPi * flux / 64.0;  // the floor's area
  EXPECT_NEAR(e.mean.x, truth, 4.0 * e.standard_error + 1e-4 * truth);
  EXPECT_LT(e.standard_error, 0.01 * truth);
}

// A cone as wide as the sphere is a point light, bit for bit but for the order of sums.
TEST(SpotLights, AWholeSphereIsAPointLight) {
  SceneBuilder spot = floor_of(), point = floor_of();
  spot.scene().spot_lights.push_back(spot_at({1, 0, 2}, {1, 0, 1}, kPi, kPi));
  point.point_light({1, 0, 2}, Rgb(10.0F));
  EXPECT_EQ(irradiance_at(spot, {0.5F, 0, 0}), irradiance_at(point, {0.5F, 0, 0}));
}

TEST(PointLights, RangeEndsTheirLight) {
  SceneBuilder b = floor_of();
  b.point_light({0, 0, 2}, Rgb(10.0F));
  b.scene().point_lights[0].range = 4.0F;
  for (const double r : {0.0, 1.0, 3.0, 3.47}) {
    const double d2 = 4.0 + r * r;
    const double truth =
        10.0 * 2.0 / std::pow(d2, 1.5) * std::max(1.0 - d2 * d2 / 256.0, 0.0);
    EXPECT_NEAR(irradiance_at(b, {static_cast<float>(r), 0, 0}), truth, 1e-4 * truth) << r;
  }
  EXPECT_EQ(irradiance_at(b, {3.5F, 0, 0}), 0.0);
}

// E = E_0 cos; nothing from behind.
TEST(DirectionalLights, IrradianceFollowsTheCosine) {
  for (const double degrees : {0.0, 30.0, 60.0, 89.0}) {
    const double angle = degrees * kPi / 180.0;
    SceneBuilder b = floor_of();
    b.scene().directional_lights.push_back({.name = "",
                                            .direction = {std::sin(angle), 0.0, -std::cos(angle)},
                                            .irradiance = {3.0F, 2.0F, 1.0F}});
    const double truth = 3.0 * std::cos(angle);
    EXPECT_NEAR(irradiance_at(b, {1, 2, 0}), truth, 1e-5 * truth) << degrees;
  }
  for (const Vec3d& direction : {Vec3d(0, 0, 1), Vec3d(1, 0, 0)}) {  // from below, along the floor
    SceneBuilder b = floor_of();
    b.scene().directional_lights.push_back(
        {.name = "", .direction = direction, .irradiance = Rgb(3.0F)});
    EXPECT_EQ(irradiance_at(b, {1, 2, 0}), 0.0);
  }
}

// The shadow of a small plate lies where the direction takes it, however far the plate is.
TEST(DirectionalLights, ShadowsAreParallel) {
  for (const float height : {1.0F, 1e3F, 1e6F}) {
    SceneBuilder b = floor_of(8.0F);
    const Vec3f at(-height, 0.0F, height);  // light comes along (1, 0, -1)
    b.quad({at + Vec3f(-1, -1, 0), at + Vec3f(1, -1, 0), at + Vec3f(1, 1, 0), at + Vec3f(-1, 1, 0)},
           b.material(diffuse_material(Rgb(0.0F))));
    b.scene().directional_lights.push_back(
        {.name = "", .direction = normalize(Vec3d(1, 0, -1)), .irradiance = Rgb(1.0F)});
    EXPECT_EQ(irradiance_at(b, {0.3F, 0.3F, 0}), 0.0) << height;
    EXPECT_GT(irradiance_at(b, {3.0F, 0.0F, 0}), 0.0) << height;
    EXPECT_GT(irradiance_at(b, {0.0F, 3.0F, 0}), 0.0) << height;
  }
}

// A translucent sheet passes light of a sun behind it: a/(2 pi) E cos to each side.
TEST(DirectionalLights, ComeThroughASheet) {
  for (const double side : {1.0, -1.0}) {
    SceneBuilder b;
    Material sheet = diffuse_material(Rgb(static_cast<float>(kAlbedo)));
    sheet.transparent = 1.0F;
    b.quad({Vec3f(-5, -5, 0), {5, -5, 0}, {5, 5, 0}, {-5, 5, 0}}, b.material(sheet));
    b.scene().directional_lights.push_back(
        {.name = "", .direction = {0.0, 0.0, -side}, .irradiance = Rgb(2.0F)});
    EXPECT_NEAR(irradiance_at(b, {1, 1, 0}), 1.0, 1e-5);
  }
}

}  // namespace
}  // namespace raykiln::render
