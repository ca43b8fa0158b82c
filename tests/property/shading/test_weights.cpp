// sample, evaluate and pdf tell one story, for every exponent, and nothing is ever NaN.
#include <gtest/gtest.h>

#include "support/bsdf_cases.hpp"

namespace raykiln::render {
namespace {

using support::at_degrees;
using support::bsdf_at;
using support::numbered;

TEST(Weights, AreValueOverDensity) {
  for (const auto& [model_name, model] : support::light_models()) {
    for (const auto& [name, material] : support::lobe_materials()) {
      for (const double degrees : {0.0, 40.0, 85.0, 140.0}) {
        const Bsdf bsdf = bsdf_at(material, at_degrees(degrees), model);
        for (std::uint64_t i = 0; i < 500; ++i) {
          const BsdfSample sample = sample_bsdf(bsdf, numbered(i));
          if (sample.lobe == Lobe::kNone) continue;
          const BsdfValue value = evaluate(bsdf, sample.wi);
          // The sample keeps the exact 1 - cos, evaluate() measures it on the float direction.
          EXPECT_NEAR(sample.pdf, value.pdf, 2e-4 * value.pdf) << name << model_name;
          EXPECT_NEAR(sample.weight.x * sample.pdf, value.f_cos.x, 2e-4 * value.f_cos.x + 1e-12)
              << name << model_name;
          EXPECT_GE(sample.weight.x, 0.0);
        }
      }
    }
  }
}

struct Tally {
  std::uint64_t bad = 0, found = 0;
};

void sample_at_every_angle(const Material& material, const BsdfModel& model, Tally& tally) {
  for (const double degrees : {0.0, 41.8, 41.9, 80.0, 89.9, 90.0 - 1e-7, 90.0, 90.1, 131.0, 138.2, 180.0}) {
    const Bsdf bsdf = bsdf_at(material, at_degrees(degrees), model);
    for (std::uint64_t i = 0; i < 100; ++i) {
      const BsdfSample s = sample_bsdf(bsdf, numbered(i));
      if (s.lobe == Lobe::kNone) continue;
      ++tally.found;
      const BsdfValue value = evaluate(bsdf, s.wi);
      tally.bad += !std::isfinite(s.weight.x) || !std::isfinite(s.pdf) || !(s.pdf > 0.0) ||
                   !std::isfinite(value.f_cos.x) || !std::isfinite(value.pdf) ||
                   std::abs(length(s.wi) - 1.0F) > 1e-5F;
    }
  }
}

// Every exponent, index and angle, also at grazing incidence and beyond the critical angle.
TEST(Weights, AreFiniteAtEveryExtreme) {
  Tally tally;
  for (const double exponent : {0.0, 0.5, 1.0, 1e4, 1e8, 1e10, 1e12, 1e300}) {
    for (const float index : {1.0F, 1.0F / 1.5F, 1.5F, 10.0F, 1e6F, 1e20F, 3e38F}) {
      for (const float transparent : {0.0F, 0.5F, 1.0F}) {
        const Material material = support::make_material(0.3F, 0.7F, transparent, exponent, index);
        for (const BsdfModel& model : {support::kSeedBsdf, support::kPhysicalBsdf}) {
          sample_at_every_angle(material, model, tally);
        }
      }
    }
  }
  EXPECT_EQ(tally.bad, 0U);
  EXPECT_GT(tally.found, 100000U);
}

// From a mirror to the roughest, at and next to grazing, above and below.
TEST(Weights, OfFacetsAreFiniteAndValueOverDensity) {
  std::uint64_t bad = 0, found = 0;
  for (const auto& [name, material] : support::facet_materials()) {
    for (const double roughness : {0.0, 1e-4, 1e-3, 0.01, 0.1, 0.3, 0.7, 1.0}) {
      for (const double degrees : {0.0, 41.8, 80.0, 89.9, 90.0 - 1e-7, 90.0, 90.1, 131.0, 138.2, 180.0}) {
        const MicrofacetBsdf bsdf = support::facets_at(material, roughness, at_degrees(degrees));
        for (std::uint64_t i = 0; i < 100; ++i) {
          const BsdfSample s = sample_bsdf(bsdf, numbered(i));
          if (s.lobe == Lobe::kNone) continue;
          ++found;
          const BsdfValue value = evaluate(bsdf, s.wi);
          bad += !std::isfinite(s.weight.x) || !(s.weight.x >= 0.0) || !std::isfinite(s.pdf) ||
                 !(s.pdf > 0.0) || !std::isfinite(value.f_cos.x) || !std::isfinite(value.pdf) ||
                 std::abs(length(s.wi) - 1.0F) > 1e-5F;
          // The sample keeps the facet that was drawn; evaluate() measures it on float directions.
          if (roughness < 0.3 || std::abs(degrees - 90.0) < 1.0) continue;
          EXPECT_NEAR(s.pdf, value.pdf, 1e-3 * value.pdf) << name << ' ' << roughness << ' ' << degrees;
          EXPECT_NEAR(s.weight.y * s.pdf, value.f_cos.y, 1e-3 * value.f_cos.y + 1e-12) << name;
        }
      }
    }
  }
  EXPECT_EQ(bad, 0U);
  EXPECT_GT(found, 20000U);
}

TEST(Weights, OfASharpMirrorAreItsReflectance) {
  for (const double exponent : {1e8, 1e10, 1e12}) {
    const Bsdf bsdf = bsdf_at(support::make_material(0.0F, 0.9F, 0.0F, exponent), at_degrees(50.0));
    for (std::uint64_t i = 0; i < 1000; ++i) {
      const BsdfSample sample = sample_bsdf(bsdf, numbered(i));
      ASSERT_EQ(sample.lobe, Lobe::kSpecular);
      EXPECT_NEAR(sample.weight.x, 0.9, 1e-3);
    }
  }
}

// cos_i / max(cos_i, cos_o) at most 1: what makes the variance finite at every silhouette.
TEST(Weights, OfThePhysicalLobeAreAtMostOne) {
  double largest = 0.0, largest_of_seed = 0.0;
  for (const double exponent : {0.0, 1.0, 10.0, 100.0, 1e4, 1e8}) {
    const Material material = support::make_material(0.0F, 1.0F, 0.0F, exponent);
    for (const double degrees : {0.0, 45.0, 80.0, 89.0, 89.99, 90.0 - 1e-7}) {
      const Bsdf physical = bsdf_at(material, at_degrees(degrees));
      const Bsdf seed = bsdf_at(material, at_degrees(degrees), support::kSeedBsdf);
      for (std::uint64_t i = 0; i < 2000; ++i) {
        largest = std::max(largest, sample_bsdf(physical, numbered(i)).weight.x);
        largest_of_seed = std::max(largest_of_seed, sample_bsdf(seed, numbered(i)).weight.x);
      }
    }
  }
  EXPECT_LE(largest, 1.0 + 4.0 * 0x1p-24);
  EXPECT_GT(largest_of_seed, 1e3);
}

// Lossless glass in both models: choosing a side by F(theta_o) while the value has F(theta_i) keeps
// weights below 1/kLeastShare = 32 for broad lobes, times what the border does to radiance.
TEST(Weights, OfBroadGlassAreBounded) {
  double largest = 0.0;
  for (const double exponent : {0.0, 1.0, 10.0, 100.0, 9e3}) {
    for (const float index : {1.01F, 1.5F, 1.0F / 1.5F, 2.4F}) {
      const Material material = support::make_material(0.0F, 1.0F, 1.0F, exponent, index);
      for (double degrees = 0.5; degrees < 180.0; degrees += 1.0) {
        const Bsdf bsdf = bsdf_at(material, at_degrees(degrees));
        for (std::uint64_t i = 0; i < 200; ++i) {
          const BsdfSample sample = sample_bsdf(bsdf, numbered(i));
          if (sample.lobe == Lobe::kNone) continue;
          largest = std::max(largest, sample.weight.x / sample.radiance_scale);
        }
      }
    }
  }
  EXPECT_LE(largest, 32.0);
}

TEST(Weights, ABlackMaterialEndsThePath) {
  const Bsdf bsdf = bsdf_at(support::make_material(0.0F, 0.0F, 0.5F, 10.0), at_degrees(20.0));
  EXPECT_TRUE(bsdf.black);
  EXPECT_EQ(sample_bsdf(bsdf, numbered(1)).lobe, Lobe::kNone);
  EXPECT_EQ(evaluate(bsdf, at_degrees(10.0)).f_cos, Rgbd(0.0));
  EXPECT_EQ(evaluate(bsdf, at_degrees(10.0)).pdf, 0.0);
}

TEST(Weights, ChannelsCanBePermuted) {
  Material a = support::make_material(0.0F, 0.0F, 0.4F, 20.0), b = a;
  a.diffuse = {0.5F, 0.2F, 0.1F};
  b.diffuse = {0.1F, 0.5F, 0.2F};
  a.specular = {0.1F, 0.3F, 0.05F};
  b.specular = {0.05F, 0.1F, 0.3F};
  const Bsdf left = bsdf_at(a, at_degrees(30.0)), right = bsdf_at(b, at_degrees(30.0));
  for (std::uint64_t i = 0; i < 1000; ++i) {
    const BsdfSample p = sample_bsdf(left, numbered(i)), q = sample_bsdf(right, numbered(i));
    EXPECT_EQ(p.wi, q.wi);
    EXPECT_EQ(p.weight, Rgbd(q.weight.y, q.weight.z, q.weight.x));
  }
}

}  // namespace
}  // namespace raykiln::render
