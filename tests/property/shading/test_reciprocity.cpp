#include <gtest/gtest.h>

#include "support/bsdf_cases.hpp"

namespace raykiln::render {
namespace {

using support::bsdf_at;
using support::make_material;
using support::numbered;

/// f(from, to): light arrives from `from` and leaves to `to`.
double value(const Material& material, const Vec3f& from, const Vec3f& to,
             const BsdfModel& model = {}) {
  const double cosine = std::abs(static_cast<double>(from.z));
  return evaluate(bsdf_at(material, to, model), from).f_cos.x / cosine;
}

Vec3f random_direction(std::uint64_t i, std::uint64_t seed) {
  return sample_uniform_sphere(uniform(numbered(i, seed), Dimension::kDirectionU),
                               uniform(numbered(i, seed), Dimension::kDirectionV));
}

TEST(Reciprocity, HoldsForDiffuseLobes) {
  for (const float transparent : {0.0F, 0.6F, 1.0F}) {
    const Material material = make_material(0.8F, 0.0F, transparent, 1.0);
    for (std::uint64_t i = 0; i < 20000; ++i) {
      const Vec3f a = random_direction(i, 1), b = random_direction(i, 2);
      const double forth = value(material, a, b), back = value(material, b, a);
      EXPECT_NEAR(forth, back, 1e-5 * forth + 1e-12);
    }
  }
}

TEST(Reciprocity, HoldsForThePhysicalLobe) {
  for (const double exponent : {0.0, 1.0, 10.0, 300.0}) {
    const Material material = make_material(0.3F, 0.7F, 0.0F, exponent);
    for (std::uint64_t i = 0; i < 20000; ++i) {
      Vec3f a = random_direction(i, 1), b = random_direction(i, 2);
      a.z = std::abs(a.z);
      b.z = std::abs(b.z);
      const double forth = value(material, a, b), back = value(material, b, a);
      // The axes are floats: cos^e is off by e times their rounding.
      EXPECT_NEAR(forth, back, (1e-5 + 1e-6 * exponent) * forth + 1e-9);
    }
  }
}

// Every term of the opaque share and of a sheet. `tint` is the same both ways.
TEST(Reciprocity, HoldsForFacets) {
  for (const auto& [name, material] : support::facet_materials()) {
    if (!material.facets.thin) continue;
    for (const double roughness : {0.2, 0.5, 1.0}) {
      for (std::uint64_t i = 0; i < 5000; ++i) {
        const Vec3f a = random_direction(i, 1), b = random_direction(i, 2);
        const auto f = [&](const Vec3f& from, const Vec3f& to) {
          return evaluate(support::facets_at(material, roughness, to), from).f_cos.x /
                 std::abs(static_cast<double>(from.z));
        };
        const double forth = f(a, b), back = f(b, a);
        EXPECT_NEAR(forth, back, 1e-4 * forth + 1e-12) << name << ' ' << roughness;
      }
    }
  }
}

// f(a, b) has 1/cos_b and f(b, a) has 1/cos_a: not reciprocal, by exactly cos_a/cos_b.
TEST(Reciprocity, FailsForTheSeedsLobeByTheRatioOfCosines) {
  const Material material = make_material(0.0F, 1.0F, 0.0F, 10.0);
  std::uint64_t compared = 0;
  for (std::uint64_t i = 0; i < 20000; ++i) {
    Vec3f a = random_direction(i, 1), b = random_direction(i, 2);
    a.z = std::abs(a.z);
    b.z = std::abs(b.z);
    const double forth = value(material, a, b, support::kSeedBsdf);
    const double back = value(material, b, a, support::kSeedBsdf);
    if (!(back > 1e-6)) continue;
    ++compared;
    const double ratio = static_cast<double>(a.z) / static_cast<double>(b.z);
    EXPECT_NEAR(forth / back, ratio, 1e-4 * ratio);
  }
  EXPECT_GT(compared, 5000U);
}

TEST(Reciprocity, OpaqueLobesAreZeroBehindTheSurface) {
  const Material material = make_material(0.5F, 0.5F, 0.0F, 0.0);
  for (std::uint64_t i = 0; i < 20000; ++i) {
    const Vec3f a = random_direction(i, 1), b = random_direction(i, 2);
    if (a.z * b.z > 0.0F) continue;
    EXPECT_EQ(value(material, a, b), 0.0);
  }
}

}  // namespace
}  // namespace raykiln::render
