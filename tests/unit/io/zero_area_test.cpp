// The exact test for triangles without area, against integer arithmetic.
#include "zero_area.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace raykiln::render::io {
namespace {

TEST(ZeroArea, PointsAndLinesHaveNone) {
  const Vec3f p(1.0F, 2.0F, 3.0F);
  const Vec3f q(4.0F, 8.0F, -6.0F);
  EXPECT_TRUE(has_zero_area(p, p, p));
  EXPECT_TRUE(has_zero_area(p, p, q));
  EXPECT_TRUE(has_zero_area(p, q, q));
  EXPECT_TRUE(has_zero_area({0, 0, 0}, {1, 1, 1}, {3, 3, 3}));
  EXPECT_TRUE(has_zero_area({0, 0, 5}, {1, 2, 5}, {-3, -6, 5}));
}

TEST(ZeroArea, TheThinnestSliverIsKept) {
  const float next = std::nextafter(0.5F, 1.0F);
  EXPECT_FALSE(has_zero_area({0, 0, 0}, {1, 1, 0}, {0.5F, next, 0}));
  EXPECT_FALSE(has_zero_area({0, 0, 0}, {1e15F, 1e15F, 0}, {0.5F, next, 0}));
  EXPECT_FALSE(has_zero_area({0, 0, 0}, {1e-30F, 0, 0}, {0, 1e-30F, 0}));
  EXPECT_FALSE(has_zero_area({0, 0, 0}, {1e-45F, 0, 0}, {0, 1e-45F, 0}));
  EXPECT_FALSE(has_zero_area({1e15F, 0, 0}, {0, 1e-30F, 0}, {-1e15F, 0, 0}));
}

TEST(ZeroArea, AgreesWithIntegerArithmetic) {
  std::mt19937 random(11);
  std::uniform_int_distribution<std::int64_t> coordinate(-(1 << 23), 1 << 23);
  std::uniform_int_distribution<std::int64_t> small(-3, 3);
  int flat = 0;
  for (int round = 0; round < 20'000; ++round) {
    std::int64_t a[3], b[3], c[3];
    const std::int64_t s = small(random);
    for (int k = 0; k < 3; ++k) {
      a[k] = coordinate(random) / 8;
      b[k] = a[k] + coordinate(random) / 16;
      c[k] = a[k] + s * (b[k] - a[k]) + (round % 2 == 0 ? 0 : small(random) / 2);
    }
    bool zero = true;
    for (int k = 0; k < 3; ++k) {
      const int m = (k + 1) % 3;
      zero = zero && (b[k] - a[k]) * (c[m] - a[m]) == (b[m] - a[m]) * (c[k] - a[k]);
    }
    const auto point = [](const std::int64_t* p) {
      return Vec3f(static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2]));
    };
    ASSERT_EQ(has_zero_area(point(a), point(b), point(c)), zero) << "round " << round;
    flat += zero ? 1 : 0;
  }
  EXPECT_GT(flat, 5000);
  EXPECT_LT(flat, 19'000);
}

}  // namespace
}  // namespace raykiln::render::io
