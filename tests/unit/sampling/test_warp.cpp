#include <gtest/gtest.h>

#include <cmath>

#include "raykiln/math/frame.hpp"
#include "raykiln/sampling/random.hpp"
#include "raykiln/sampling/warp.hpp"
#include "support/statistics.hpp"

namespace raykiln::render {
namespace {

const std::vector<double> kExponents{0.0, 0.5, 1.0, 10.0, 1e4, 1e6, 1e7, 1e8, 1e9, 1e10, 1e12};

VertexKey key(std::uint64_t i) { return vertex_key(path_key(3, i, 0), 0, 0); }

TEST(Warp, TurnsAboutTheAxisAreThoseOfSineAndCosine) {
  for (int i = 0; i <= 4096; ++i) {
    for (const double v : {i / 4097.0, std::nextafter(i / 4096.0, 0.0)}) {
      if (v >= 1.0) continue;
      const Vec3f w = around_axis({0.0F, 0.0F, 1.0F}, 1.0, v);
      EXPECT_NEAR(static_cast<double>(w.x), std::cos(2.0 * kPi * v), 0x1p-24) << v;
      EXPECT_NEAR(static_cast<double>(w.y), std::sin(2.0 * kPi * v), 0x1p-24) << v;
    }
  }
}

// v = -(e + 1) ln cos is Exp(1), measured on the float direction itself and not on the number that
// made it. 11 exponents at p > 1e-4: false alarm 1.1e-3.
TEST(Warp, LobeOfEveryExponentHasItsDistribution) {
  for (const double exponent : kExponents) {
    std::vector<double> v;
    double mean_power = 0.0;
    constexpr int kCount = 100000;
    for (std::uint64_t i = 0; i < kCount; ++i) {
      const Vec3f axis = sample_uniform_sphere(uniform(key(i), Dimension::kLightU),
                                               uniform(key(i), Dimension::kLightV));
      const double x = sample_one_minus_cos(uniform(key(i), Dimension::kDirectionU), exponent);
      const Vec3f w = around_axis(axis, x, uniform(key(i), Dimension::kDirectionV));
      ASSERT_NEAR(length(w), 1.0F, 1e-6F);
      const double measured = std::min(one_minus_cos(axis, w), 1.0 - 1e-16);
      v.push_back(-(exponent + 1.0) * std::log1p(-measured));
      mean_power += std::exp(exponent * std::log1p(-measured)) / kCount;
    }
    EXPECT_GT(support::kolmogorov_smirnov_p(v, [](double t) { return -std::expm1(-t); }), 1e-4)
        << exponent;
    EXPECT_NEAR(mean_power, (exponent + 1.0) / (2.0 * exponent + 1.0), 4.0 * 0.6 / std::sqrt(kCount))
        << exponent;
  }
}

TEST(Warp, ExtremesOfTheRandomNumberStayFinite) {
  for (const double exponent : {0.0, 1.0, 1e10, 1e15}) {
    for (const double u : {0.0, 0x1p-53, 0x1p-32, 0.5, 1.0 - 0x1p-24, 1.0 - 0x1p-53}) {
      const double x = sample_one_minus_cos(u, exponent);
      EXPECT_GE(x, 0.0);
      EXPECT_LT(x, 1.0);
      EXPECT_GT(cosine_power_pdf(x, exponent), 0.0) << u << ' ' << exponent;
      EXPECT_TRUE(std::isfinite(cosine_power_pdf(x, exponent)));
      for (const double v : {0.0, 0.25, 1.0 - 0x1p-53}) {
        const Vec3f w = around_axis({0.0F, 0.0F, -1.0F}, x, v);
        EXPECT_NEAR(length(w), 1.0F, 1e-6F);
      }
    }
  }
}

// 0^0 is 1 for std::pow, which would spread exponent 0 over the whole sphere.
TEST(Warp, NoLobeReachesBehindItsAxis) {
  for (const double exponent : kExponents) {
    EXPECT_EQ(cosine_power_pdf(1.0, exponent), 0.0);
    EXPECT_EQ(cosine_power_pdf(1.5, exponent), 0.0);
    EXPECT_EQ(cosine_power_pdf(std::nan(""), exponent), 0.0);
  }
}

// Mean 0 and mean square 1/3 of each coordinate, 4 sigma each: false alarm 4e-4.
TEST(Warp, UniformSphere) {
  Vec3d sum(0.0), squares(0.0);
  constexpr int kCount = 100000;
  for (std::uint64_t i = 0; i < kCount; ++i) {
    const Vec3d w(sample_uniform_sphere(uniform(key(i), Dimension::kDirectionU),
                                        uniform(key(i), Dimension::kDirectionV)));
    ASSERT_NEAR(length(w), 1.0, 1e-6);
    sum += w;
    squares += w * w;
  }
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(sum[axis] / kCount, 0.0, 4.0 * std::sqrt(1.0 / 3.0 / kCount));
    EXPECT_NEAR(squares[axis] / kCount, 1.0 / 3.0, 4.0 * std::sqrt(4.0 / 45.0 / kCount));
  }
}

// Each of the four similar quarters of the triangle gets a quarter. 4 sigma: false alarm 2.5e-4.
TEST(Warp, UniformTriangle) {
  std::array<double, 4> seen{};
  constexpr int kCount = 100000;
  for (std::uint64_t i = 0; i < kCount; ++i) {
    const TrianglePoint p = sample_uniform_triangle(uniform(key(i), Dimension::kLightU),
                                                    uniform(key(i), Dimension::kLightV));
    ASSERT_GE(p.b1, 0.0);
    ASSERT_GE(p.b2, 0.0);
    ASSERT_LE(p.b1 + p.b2, 1.0 + 1e-15);
    const bool corner0 = p.b1 + p.b2 < 0.5;
    seen[p.b1 > 0.5 ? 0 : p.b2 > 0.5 ? 1 : corner0 ? 2 : 3] += 1.0;
  }
  for (const double n : seen) EXPECT_NEAR(n / kCount, 0.25, 4.0 * std::sqrt(0.1875 / kCount));
}

}  // namespace
}  // namespace raykiln::render
