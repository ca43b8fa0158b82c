// Which side is which: geometric normals decide sides, shading normals give cosines.
#include <gtest/gtest.h>

#include "raykiln/shading/fresnel.hpp"
#include "support/bsdf_cases.hpp"

namespace raykiln::render {
namespace {

using support::at_degrees;
using support::bsdf_at;
using support::kUp;
using support::make_material;
using support::kPhysicalBsdf;
using support::numbered;

TEST(BsdfSides, ValuesOfTheSeedsFormulas) {
  // Diffuse: a/pi opaque; a/(2 pi) to both sides where transparent.
  const Vec3f wo = at_degrees(20.0), above = at_degrees(50.0), below = at_degrees(130.0);
  const double cosine = std::cos(50.0 * kPi / 180.0);
  const auto f = [&](const Material& m, const Vec3f& wi) {
    return evaluate(bsdf_at(m, wo, support::kSeedBsdf), wi).f_cos.x / cosine;
  };
  EXPECT_NEAR(f(make_material(0.8F, 0, 0.0F, 1), above), 0.8 / kPi, 1e-6);
  EXPECT_EQ(f(make_material(0.8F, 0, 0.0F, 1), below), 0.0);
  EXPECT_NEAR(f(make_material(0.8F, 0, 1.0F, 1), above), 0.4 / kPi, 1e-6);
  EXPECT_NEAR(f(make_material(0.8F, 0, 1.0F, 1), below), 0.4 / kPi, 1e-6);
  EXPECT_NEAR(f(make_material(0.8F, 0, 0.25F, 1), below), 0.25 * 0.4 / kPi, 1e-6);
  // Phong: (e + 1)/(2 pi) cos^e(alpha) / cos(theta_o); wi in the plane of wo, 70 degrees between.
  const double alpha = std::cos(70.0 * kPi / 180.0);
  EXPECT_NEAR(f(make_material(0, 0.5F, 0.0F, 3), above),
              0.5 * 4.0 / (2.0 * kPi) * alpha * alpha * alpha / std::cos(20.0 * kPi / 180.0), 1e-6);
}

TEST(BsdfSides, TransparentLobeSplitsByTheAngleOfArrival) {
  const Material glass = make_material(0, 1, 1, 7.0);
  const Vec3f wo = at_degrees(20.0), above = at_degrees(50.0), below = at_degrees(160.0);
  const double lobe_above = 8.0 / (2.0 * kPi) * std::pow(std::cos(70.0 * kPi / 180.0), 7.0);
  const double f_above = evaluate(bsdf_at(glass, wo, support::kSeedBsdf), above).f_cos.x / std::cos(50.0 * kPi / 180.0);
  const auto schlick = [](double rare_cosine) { return 0.04 + 0.96 * std::pow(1.0 - rare_cosine, 5.0); };
  EXPECT_NEAR(f_above, schlick(std::cos(50.0 * kPi / 180.0)) * lobe_above / std::cos(20.0 * kPi / 180.0),
              1e-6);
  // Below: lobe about the refraction of wo, 1/cos of that, and 1 - F of the ray that arrives at 20
  // degrees inside the glass, 30.87 outside.
  const double theta_t = std::asin(std::sin(20.0 * kPi / 180.0) / 1.5);
  // wi and the refracted direction lie on the same side of the normal's azimuth or across it.
  const double between = 20.0 * kPi / 180.0 + theta_t;
  const double outside = std::asin(1.5 * std::sin(20.0 * kPi / 180.0));
  const double f_below = evaluate(bsdf_at(glass, wo, support::kSeedBsdf), below).f_cos.x / std::cos(20.0 * kPi / 180.0);
  EXPECT_NEAR(f_below,
              (1.0 - schlick(std::cos(outside))) * 8.0 / (2.0 * kPi) *
                  std::pow(std::cos(between), 7.0) / std::cos(theta_t),
              1e-6);
}

// The same two values in the physical model: over the larger cosine, with Fresnel's equations and,
// seen from index 1 into index 1.5, radiance divided by 1.5^2.
TEST(BsdfSides, ValuesOfThePhysicalFormulas) {
  const auto cosine = [](double degrees) { return std::cos(degrees * kPi / 180.0); };
  const Material glass = make_material(0, 1, 1, 7.0);
  const Vec3f wo = at_degrees(60.0), above = at_degrees(50.0), below = at_degrees(160.0);
  const double lobe_above = 8.0 / (2.0 * kPi) * std::pow(cosine(110.0), 7.0);
  EXPECT_EQ(evaluate(bsdf_at(glass, wo), above).f_cos.x, 0.0);  // 110 degrees off: behind the lobe
  EXPECT_LT(lobe_above, 0.0);
  const Vec3f near = at_degrees(20.0);
  const double lobe = 8.0 / (2.0 * kPi) * std::pow(cosine(70.0), 7.0);
  EXPECT_NEAR(evaluate(bsdf_at(glass, near), above).f_cos.x / cosine(50.0),
              fresnel_exact(cosine(50.0), 1.0, 1.5).reflectance * lobe / cosine(20.0), 1e-6);
  const double theta_t = std::asin(std::sin(20.0 * kPi / 180.0) / 1.5);
  const double between = 20.0 * kPi / 180.0 + theta_t;
  EXPECT_NEAR(evaluate(bsdf_at(glass, near), below).f_cos.x / cosine(20.0),
              (1.0 - fresnel_exact(cosine(20.0), 1.5, 1.0).reflectance) * 8.0 / (2.0 * kPi) *
                  std::pow(std::cos(between), 7.0) / std::max(std::cos(theta_t), cosine(20.0)) / 2.25,
              1e-6);
  EXPECT_NEAR(bsdf_at(glass, near).radiance_scale, 1.0 / 2.25, 1e-12);
  EXPECT_NEAR(bsdf_at(glass, below).radiance_scale, 2.25, 1e-12);
  EXPECT_EQ(bsdf_at(glass, near, support::kSeedBsdf).radiance_scale, 1.0);
}

TEST(BsdfSides, BehindTheGeometricNormalIsTheMaterial) {
  const Material glass = make_material(0, 1, 1, 1e10);
  EXPECT_EQ(bsdf_at(glass, at_degrees(10.0)).eta_t, 1.5);
  EXPECT_EQ(bsdf_at(glass, at_degrees(10.0)).eta_o, 1.0);
  EXPECT_EQ(bsdf_at(glass, at_degrees(170.0)).eta_o, 1.5);
  // Beyond the critical angle nothing is refracted; just within it something is.
  EXPECT_EQ(bsdf_at(glass, at_degrees(180.0 - 41.9)).cos_t, 0.0);
  EXPECT_GT(bsdf_at(glass, at_degrees(180.0 - 41.7)).cos_t, 0.0);
}

// Normals that lean away from the viewer or are turned inside out: no light through an opaque
// surface, never negative, never NaN.
TEST(BsdfSides, OddShadingNormalsStayHarmless) {
  const Material opaque = make_material(0.5F, 0.5F, 0.0F, 10.0);
  for (std::uint64_t i = 0; i < 20000; ++i) {
    const VertexKey key = numbered(i);
    const Vec3f ns = sample_uniform_sphere(uniform(key, Dimension::kLensX), uniform(key, Dimension::kLensY));
    const Vec3f wo = sample_uniform_sphere(uniform(key, Dimension::kLightU), uniform(key, Dimension::kLightV));
    const Vec3f wi = sample_uniform_sphere(uniform(key, Dimension::kEnvironmentU), uniform(key, Dimension::kEnvironmentV));
    const Bsdf bsdf = make_bsdf(opaque, kUp, ns, wo, {});
    EXPECT_GT(bsdf.cos_o, 0.0);
    const BsdfValue value = evaluate(bsdf, wi);
    EXPECT_GE(value.f_cos.x, 0.0);
    EXPECT_TRUE(std::isfinite(value.f_cos.x) && std::isfinite(value.pdf));
    if (wo.z * wi.z <= 0.0F) {
      EXPECT_EQ(value.f_cos.x, 0.0);
    }
    const BsdfSample sample = sample_bsdf(bsdf, key);
    if (sample.lobe != Lobe::kNone) {
      EXPECT_GT(sample.wi.z * wo.z, 0.0F);
    }
  }
}

// Near grazing too, where cosines measured on rounded directions differ by 1e-7 tan(theta).
TEST(BsdfSides, AtTheLargestExponentAMirrorTakesNothingAndAPaneIsNotThere) {
  const Material mirror = support::make_material(0.0F, 1.0F, 0.0F, kLargestExponent);
  const Material pane = support::make_material(0.0F, 1.0F, 1.0F, kLargestExponent, 1.0F);
  for (const support::NamedModel& m : {support::NamedModel{"physical", support::kPhysicalBsdf}, support::NamedModel{"seed", support::kSeedBsdf}}) {
    for (const double degrees : {0.0, 30.0, 60.0, 85.0, 89.9, 89.9999}) {
      const Vec3f wo = support::at_degrees(degrees);
      for (const double u : {0.1, 0.5, 0.9}) {
        const DirectionNumbers numbers{.lobe = 0.5, .side = 0.5, .u = u, .v = 0.3};
        const BsdfSample reflected = sample_bsdf(make_opaque_bsdf(mirror, kUp, kUp, wo, m.model), numbers);
        EXPECT_EQ(reflected.wi, Vec3f(-wo.x, -wo.y, wo.z)) << m.name << ' ' << degrees;
        EXPECT_NEAR(reflected.weight.x, 1.0, 4e-16) << m.name << ' ' << degrees;
        if (m.model.light.fresnel == FresnelFormula::kSchlick) continue;  // not 0 at index 1
        const BsdfSample through = sample_bsdf(make_bsdf(pane, kUp, kUp, wo, m.model), numbers);
        EXPECT_EQ(through.wi, -wo) << m.name << ' ' << degrees;
        EXPECT_NEAR(through.weight.x, 1.0, 4e-16) << m.name << ' ' << degrees;
      }
    }
  }
}

/// What a vertex shader leaves out for them is 0.
TEST(BsdfSides, MirrorsAndClearBordersScatterAlongTheirAxesAlone) {
  for (const float transparent : {0.0F, 0.5F, 1.0F}) {
    for (const double degrees : {1.0, 45.0, 80.0}) {
      const Bsdf b = bsdf_at(make_material(0, 0.9F, transparent, kLargestExponent), at_degrees(degrees), kPhysicalBsdf);
      EXPECT_TRUE(scatters_along_axes_alone(b));
      for (const Vec3f& axis : {b.mirror, b.refracted}) {
        if (axis == Vec3f(0.0F)) continue;
        const Vec3d aside = normalize(cross(Vec3d(axis), Vec3d(0.3, 0.9, -0.2)));
        for (const double distance : {1.0001, 3.0, 1e3}) {
          const Vec3f wi(normalize(Vec3d(axis) + distance * kAxisWidth * aside));
          EXPECT_EQ(evaluate(b, wi).f_cos, Rgbd(0.0)) << transparent << ' ' << degrees << ' ' << distance;
        }
      }
    }
  }
  EXPECT_FALSE(scatters_along_axes_alone(bsdf_at(make_material(0, 0.9F, 1, 1e14), kUp, kPhysicalBsdf)));
  EXPECT_FALSE(scatters_along_axes_alone(bsdf_at(make_material(0.1F, 0.9F, 1, kLargestExponent), kUp, kPhysicalBsdf)));
}

/// Numbers that no lobe asks for are not drawn; the sample is that of all four.
TEST(BsdfSides, NumbersOnDemandGiveTheSameSample) {
  std::vector<support::NamedMaterial> materials = support::lobe_materials();
  materials.push_back({"mirror", make_material(0, 0.9F, 0, kLargestExponent)});
  materials.push_back({"clear", make_material(0, 1, 1, kLargestExponent)});
  for (const auto& [name, material] : materials) {
    for (std::uint64_t i = 0; i < 200; ++i) {
      const Bsdf b = bsdf_at(material, at_degrees(1.0 + static_cast<double>(i % 89)), kPhysicalBsdf);
      const VertexKey key = vertex_key(path_key(5, i, 0), 0, 0);
      const BsdfSample all = sample_bsdf(b, direction_numbers(key)), few = sample_bsdf(b, key);
      EXPECT_EQ(all.wi, few.wi) << name;
      EXPECT_EQ(all.weight, few.weight) << name;
      EXPECT_EQ(all.pdf, few.pdf) << name;
      EXPECT_EQ(all.lobe, few.lobe) << name;
    }
  }
}

}  // namespace
}  // namespace raykiln::render
