#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "raykiln/sampling/warp.hpp"
#include "raykiln/shading/fresnel.hpp"

namespace raykiln::render {
namespace {

TEST(Fresnel, NormalIncidenceIsTheSquareOfTheIndexContrast) {
  for (const auto& [n, truth] : {std::pair{1.5, 0.04}, {10.0, 0.669421}, {1e3, 0.996008},
                                 {1e6, 0.999996}, {1.0, 0.0}}) {
    EXPECT_NEAR(fresnel_schlick(1.0, 1.0, n).reflectance, truth, 1e-6) << n;
    EXPECT_NEAR(fresnel_schlick(1.0, n, 1.0).reflectance, truth, 1e-6) << n;
  }
}

// Hemispherical averages 2 * integral of F c dc of Schlick's formula: R0 + (1 - R0)/21.
TEST(Fresnel, AverageFromTheRareSide) {
  for (const auto& [n, truth] : {std::pair{1.01, 0.047643}, {1.1, 0.049779}, {1.33, 0.066723},
                                 {1.5, 0.085714}, {2.4, 0.209095}, {10.0, 0.685163}}) {
    double sum = 0.0;
    constexpr int kSteps = 20000;
    for (int i = 0; i < kSteps; ++i) {
      const double c = (i + 0.5) / kSteps;
      sum += 2.0 * c * fresnel_schlick(c, 1.0, n).reflectance / kSteps;
    }
    EXPECT_NEAR(sum, truth, 2e-6) << n;
  }
}

// From inside the curve runs up to 1 at the critical angle without a jump: with the dense angle it
// would leap by 0.96 there.
TEST(Fresnel, ContinuousOnTheDenseSide) {
  double before = fresnel_schlick(1.0, 1.5, 1.0).reflectance, largest_step = 0.0;
  for (int i = 1; i <= 100000; ++i) {
    const double cosine = std::cos(0.5 * kPi * i / 100000.0);
    const double now = fresnel_schlick(cosine, 1.5, 1.0).reflectance;
    largest_step = std::max(largest_step, now - before);
    EXPECT_GE(now, before - 1e-12);
    before = now;
  }
  EXPECT_LE(largest_step, 0.05);
  EXPECT_EQ(before, 1.0);
}

// 8 floats to each side of the critical angle, where a float or asin() would lose half the digits.
TEST(Fresnel, NeighboursOfTheCriticalAngle) {
  float cosine = 0.745355992F;
  for (int i = 0; i < 8; ++i) cosine = std::nextafterf(cosine, 0.0F);
  int total = 0;
  for (int i = 0; i < 17; ++i, cosine = std::nextafterf(cosine, 1.0F)) {
    const auto c = static_cast<long double>(cosine);
    const long double cos2_t = 1.0L - 2.25L * (1.0L - c) * (1.0L + c);
    const double cos_t = cos2_t > 0.0L ? static_cast<double>(std::sqrt(cos2_t)) : 0.0;
    const FresnelTerm term = fresnel_schlick(static_cast<double>(cosine), 1.5, 1.0);
    EXPECT_NEAR(term.reflectance, 0.04 + 0.96 * std::pow(1.0 - cos_t, 5.0), 1e-6);
    EXPECT_NEAR(term.cos_t, cos_t, 1e-6);
    EXPECT_EQ(term.total_reflection, term.cos_t == 0.0);
    total += term.total_reflection;
  }
  EXPECT_GT(total, 0);
  EXPECT_LT(total, 17);
}

// Averages of Fresnel's equations; from inside the average is 1 - (1 - outer average)/n^2.
TEST(Fresnel, ExactAverages) {
  for (const auto& [n, truth] : {std::pair{1.01, 0.003146}, {1.1, 0.025157}, {1.33, 0.065931},
                                 {1.5, 0.091778}, {1.8, 0.134054}, {2.4, 0.210181}, {4.0, 0.366638},
                                 {10.0, 0.640175}}) {
    double outer = 0.0, inner = 0.0;
    constexpr int kSteps = 200000;
    for (int i = 0; i < kSteps; ++i) {
      const double c = (i + 0.5) / kSteps;
      outer += 2.0 * c * fresnel_exact(c, 1.0, n).reflectance / kSteps;
      inner += 2.0 * c * fresnel_exact(c, n, 1.0).reflectance / kSteps;
    }
    EXPECT_NEAR(outer, truth, 2e-6) << n;
    EXPECT_NEAR(inner, 1.0 - (1.0 - outer) / (n * n), 2e-6) << n;
  }
}

TEST(Fresnel, ExactAtItsExtremes) {
  for (const double cosine : {1.0, 0.5, 1e-8, 0.0}) {
    EXPECT_EQ(fresnel_exact(cosine, 1.0, 1.0).reflectance, 0.0);
    EXPECT_EQ(fresnel_exact(cosine, 1.0, 1.0).cos_t, cosine);
    EXPECT_EQ(fresnel_exact(cosine, 1.5, 1.5).reflectance, 0.0);
  }
  EXPECT_EQ(fresnel_exact(0.0, 1.0, 1.5).reflectance, 1.0);
  EXPECT_TRUE(fresnel_exact(0.0, 1.5, 1.0).total_reflection);
  for (const auto& [n, truth] : {std::pair{1.5, 0.04}, {10.0, 0.669421}, {1e3, 0.996008},
                                 {1e6, 0.999996}, {1e20, 1.0}, {3.4e38, 1.0}, {1e-20, 1.0}}) {
    EXPECT_NEAR(fresnel_exact(1.0, 1.0, n).reflectance, truth, 1e-6) << n;
    EXPECT_NEAR(fresnel_exact(1.0, n, 1.0).reflectance, truth, 1e-6) << n;
  }
  // Brewster's angle: only one polarisation is reflected, and the other by ((n^2 - 1)/(n^2 + 1))^2.
  EXPECT_NEAR(fresnel_exact(std::cos(std::atan(1.5)), 1.0, 1.5).reflectance,
              0.5 * std::pow(1.25 / 3.25, 2.0), 1e-12);
}

TEST(Fresnel, IndexOneIsSchlicksFloorAlone) {
  const double cosine = std::cos(85.0 * kPi / 180.0);
  EXPECT_NEAR(fresnel_schlick(cosine, 1.0, 1.0).reflectance, 0.634, 1e-3);
  EXPECT_NEAR(fresnel_schlick(cosine, 1.0, 1.0).cos_t, cosine, 1e-12);
}

TEST(Fresnel, RefractionObeysSnellAndReturns) {
  for (const double degrees : {0.0, 20.0, 60.0, 89.0}) {
    const double theta = degrees * kPi / 180.0, cosine = std::cos(theta);
    const Vec3d n(0.0, 0.0, 1.0), w(std::sin(theta), 0.0, cosine);
    const FresnelTerm in = fresnel_schlick(cosine, 1.0, 1.5);
    const Vec3d t = refract(w, n, cosine, in.cos_t, 1.0, 1.5);
    EXPECT_NEAR(t.x, -std::sin(theta) / 1.5, 1e-12);
    EXPECT_NEAR(t.z, -in.cos_t, 1e-12);
    const FresnelTerm out = fresnel_schlick(-t.z, 1.5, 1.0);
    EXPECT_NEAR(out.cos_t, cosine, 1e-12);
    EXPECT_NEAR(out.reflectance, in.reflectance, 1e-12);
    const Vec3d back = refract(t, -n, -t.z, out.cos_t, 1.5, 1.0);
    EXPECT_NEAR(back.x, w.x, 1e-12);
    EXPECT_NEAR(back.z, w.z, 1e-12);
  }
}

}  // namespace
}  // namespace raykiln::render
