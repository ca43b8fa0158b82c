#include <gtest/gtest.h>

#include "raykiln/accel/kdtree_data.hpp"
#include "raykiln/math/float_bits.hpp"
#include "support/mesh_generators.hpp"

namespace raykiln::test {
namespace {

using render::has_zero_area;

TEST(ExactArea, PointsOnALineHaveNone) {
  EXPECT_TRUE(has_zero_area({1, 2, 3}, {1, 2, 3}, {1, 2, 3}));
  EXPECT_TRUE(has_zero_area({1, 2, 3}, {1, 2, 3}, {4, 5, 7}));
  EXPECT_TRUE(has_zero_area({0, 0, 0}, {1, 2, 3}, {3, 6, 9}));
  EXPECT_TRUE(has_zero_area({5, 0, 0}, {-3, 0, 0}, {1e30F, 0, 0}));
  TestRandom random(1);
  for (int i = 0; i < 10000; ++i) {  // integers: exactly collinear
    const auto whole = [&] { return static_cast<float>(random.below(2000)) - 1000.0F; };
    const Vec3f a(whole(), whole(), whole());
    const Vec3f d(whole(), whole(), whole());
    EXPECT_TRUE(has_zero_area(a, a + d, a - 3.0F * d));
  }
}

TEST(ExactArea, ThinTrianglesHaveSome) {
  EXPECT_FALSE(has_zero_area({0, 0, 0}, {1, 0, 0}, {0, 1, 0}));
  EXPECT_FALSE(has_zero_area({0, 0, 0}, {1, 0, 0}, {0.5F, 1e-45F, 0}));
  EXPECT_FALSE(has_zero_area({0, 0, 0}, {1e-44F, 0, 0}, {0, 0, 1e-45F}));
  EXPECT_FALSE(has_zero_area({1e30F, 0, 0}, {-1e30F, 0, 0}, {0, 1e-30F, 0}));
  const float next = render::next_up(1.0F);
  EXPECT_FALSE(has_zero_area({0, 0, 0}, {1, 1, 1}, {next, 1, 1}));
  EXPECT_FALSE(has_zero_area({1e8F, 1e-8F, 0}, {0, 0, 0}, {-1e8F, 0, 0}));
}

// Collinear up to rounding, judged by exact integer arithmetic: coordinates are multiples of
// 2^-20 below 1, so the cross product fits 64 bits.
TEST(ExactArea, AgreesWithIntegerArithmetic) {
  TestRandom random(2);
  int thin = 0;
  for (int i = 0; i < 100'000; ++i) {
    std::array<std::array<std::int64_t, 2>, 3> p{};
    for (int c = 0; c < 2; ++c) {
      for (auto& x : p[static_cast<std::size_t>(c)]) x = random.below(1U << 12);
    }
    const std::int64_t times = std::int64_t{random.below(9)} - 4;
    for (std::size_t k = 0; k < 2; ++k) {
      p[2][k] = p[0][k] + times * (p[1][k] - p[0][k]) + (random.below(8) == 0 ? 1 : 0);
    }
    const std::int64_t area = (p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) -
                              (p[1][1] - p[0][1]) * (p[2][0] - p[0][0]);
    thin += area != 0 ? 1 : 0;
    const auto point = [&](std::size_t c) {
      return Vec3f(static_cast<float>(p[c][0]) * 0x1p-20F, static_cast<float>(p[c][1]) * 0x1p-20F,
                   0.25F);
    };
    EXPECT_EQ(has_zero_area(point(0), point(1), point(2)), area == 0);
  }
  EXPECT_GT(thin, 5000);
}

}  // namespace
}  // namespace raykiln::test
