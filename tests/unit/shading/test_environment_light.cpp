#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "raykiln/sampling/warp.hpp"
#include "raykiln/shading/environment_light.hpp"

namespace raykiln::render {
namespace {

EnvironmentLight light_of(int width, int height, const std::vector<Rgb>& texels,
                          double rotation_rad = 0.0) {
  EnvironmentMap map{.name = "", .width = width, .height = height, .rgb = {},
                     .rotation_rad = rotation_rad};
  for (const Rgb& t : texels) map.rgb.insert(map.rgb.end(), {t.x, t.y, t.z});
  return EnvironmentLight(std::make_shared<const EnvironmentMap>(std::move(map)));
}

/// Texel i has radiance i + 1.
EnvironmentLight numbered(int width, int height, double rotation_rad = 0.0) {
  std::vector<Rgb> texels;
  for (int i = 0; i < width * height; ++i) texels.emplace_back(static_cast<float>(i + 1));
  return light_of(width, height, texels, rotation_rad);
}

// Row 0 is up; the middle of the picture is -z, right of it +x, its edge +z.
TEST(EnvironmentLight, DirectionsOfTheMap) {
  const EnvironmentLight light = numbered(8, 4);
  const auto at = [&](const Vec3d& d) { return static_cast<int>(light.towards(d).radiance.x) - 1; };
  EXPECT_EQ(at({0.01, 1.0, -0.02}), 4);            // zenith, row 0
  EXPECT_EQ(at({0.01, -1.0, -0.02}), 3 * 8 + 4);   // nadir, last row
  EXPECT_EQ(at({0.1, 0.1, -1.0}), 8 + 4);          // just right of the middle
  EXPECT_EQ(at({-0.1, 0.1, -1.0}), 8 + 3);
  EXPECT_EQ(at({1.0, 0.1, -0.1}), 8 + 5);          // +x: three quarters along the row
  EXPECT_EQ(at({1.0, 0.1, 0.1}), 8 + 6);
  EXPECT_EQ(at({0.1, 0.1, 1.0}), 8 + 7);           // +z, the right edge
  EXPECT_EQ(at({-0.1, 0.1, 1.0}), 8 + 0);
  EXPECT_EQ(at({-1.0, 0.1, -0.1}), 8 + 2);
}

// A quarter turn counter-clockwise seen from above takes what was at -z to -x.
TEST(EnvironmentLight, RotationTurnsTheMapAboutTheVertical) {
  const EnvironmentLight straight = numbered(8, 4), turned = numbered(8, 4, 0.5 * kPi);
  for (const Vec3d& d : {Vec3d(0.3, 0.2, -1.0), Vec3d(1.0, -0.4, 0.2), Vec3d(-0.5, 0.9, 0.7)}) {
    EXPECT_EQ(turned.towards({d.z, d.y, -d.x}).radiance, straight.towards(d).radiance);
  }
  EXPECT_EQ(turned.towards({-1.0, 0.1, -0.1}).radiance, straight.towards({0.1, 0.1, -1.0}).radiance);
}

TEST(EnvironmentLight, TheTotalIsTheIntegralOverTheSphere) {
  EXPECT_NEAR(light_of(16, 8, std::vector<Rgb>(128, Rgb(0.5F, 2.0F, 1.0F))).total(), 8.0 * kPi, 1e-12);
  // One texel of 4 x 2 at radiance 3: an eighth of the sphere.
  std::vector<Rgb> one(8, Rgb(0.0F));
  one[5] = Rgb(3.0F, 0.0F, 0.0F);
  EXPECT_NEAR(light_of(4, 2, one).total(), 3.0 * 4.0 * kPi / 8.0, 1e-12);
}

// A constant map is drawn uniformly: the density is 1/(4 pi) everywhere, at the poles too.
TEST(EnvironmentLight, AConstantMapIsUniform) {
  const EnvironmentLight light = light_of(32, 16, std::vector<Rgb>(512, Rgb(0.7F)));
  for (std::uint64_t i = 0; i < 2000; ++i) {
    const EnvironmentSample s = light.sample(vertex_key(path_key(3, i, 0), 0, 0));
    EXPECT_NEAR(s.pdf * 4.0 * kPi, 1.0, 1e-12);
    EXPECT_NEAR(length(s.wi), 1.0, 1e-12);
  }
}

TEST(EnvironmentLight, SamplesAreWhereTheLookUpFindsThem) {
  for (const double rotation : {0.0, 1.0, -2.5}) {
    const EnvironmentLight light = numbered(12, 7, rotation);
    for (std::uint64_t i = 0; i < 5000; ++i) {
      const EnvironmentSample s = light.sample(vertex_key(path_key(4, i, 0), 0, 0));
      const EnvironmentLight::Seen seen = light.towards(s.wi);
      ASSERT_EQ(seen.radiance, s.radiance);
      ASSERT_EQ(seen.pdf, s.pdf);
    }
  }
}

TEST(EnvironmentLight, BlackTexelsAreNeverDrawn) {
  std::vector<Rgb> texels(6 * 5, Rgb(0.0F));
  texels[13] = Rgb(0.0F, 1e-20F, 0.0F);
  texels[14] = Rgb(1e20F, 0.0F, 0.0F);
  const EnvironmentLight light = light_of(6, 5, texels);
  for (const double u : {0.0, 0.3, 0.999999999999, 1.0 - 0x1p-53}) {
    for (const double v : {0.0, 0x1p-53, 0.5, 1.0 - 0x1p-53}) {
      const EnvironmentSample s = light.sample(u, v);
      EXPECT_GT(s.pdf, 0.0);
      EXPECT_GT(s.radiance.x + s.radiance.y, 0.0);
      EXPECT_TRUE(std::isfinite(s.wi.x + s.wi.y + s.wi.z));
    }
  }
  EXPECT_FALSE(light_of(2, 2, std::vector<Rgb>(4, Rgb(0.0F))).shines());
}

// Not a bit of a draw depends on a power of two in all radiances, or on the order of channels.
TEST(EnvironmentLight, ScalingAndPermutingChangeNoDraw) {
  std::vector<Rgb> plain, scaled, permuted;
  for (int i = 0; i < 40; ++i) {
    const Rgb c(0.1F * static_cast<float>(i % 7), 0.05F * static_cast<float>(i % 11), 0.3F);
    plain.push_back(c);
    scaled.push_back(c * 0x1p30F);
    permuted.emplace_back(c.z, c.x, c.y);
  }
  const EnvironmentLight a = light_of(8, 5, plain), b = light_of(8, 5, scaled), c = light_of(8, 5, permuted);
  for (std::uint64_t i = 0; i < 500; ++i) {
    const VertexKey key = vertex_key(path_key(5, i, 0), 0, 0);
    EXPECT_EQ(a.sample(key).wi, b.sample(key).wi);
    EXPECT_EQ(a.sample(key).pdf, b.sample(key).pdf);
    EXPECT_EQ(a.sample(key).wi, c.sample(key).wi);
  }
}

}  // namespace
}  // namespace raykiln::render
