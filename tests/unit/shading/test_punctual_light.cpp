#include <gtest/gtest.h>

#include <cmath>

#include "raykiln/shading/punctual_light.hpp"

namespace raykiln::render {
namespace {

TEST(RangeShare, FallsWithTheFourthPowerAndEnds) {
  EXPECT_EQ(range_share(1e30, kEndlessRange), 1.0);
  EXPECT_EQ(range_share(0.0, 2.0F), 1.0);
  EXPECT_DOUBLE_EQ(range_share(1.0, 2.0F), 1.0 - 1.0 / 16.0);
  EXPECT_EQ(range_share(4.0, 2.0F), 0.0);
  EXPECT_EQ(range_share(1e300, 2.0F), 0.0);
}

SpotLight spot(double inner_rad, double outer_rad) {
  SpotLight light;
  light.inner_one_minus_cos = 2.0 * std::pow(std::sin(0.5 * inner_rad), 2);
  light.outer_one_minus_cos = 2.0 * std::pow(std::sin(0.5 * outer_rad), 2);
  return light;
}

Vec3d away(double angle_rad) { return {std::sin(angle_rad), 0.0, -std::cos(angle_rad)}; }

// The reference code of KHR_lights_punctual, in double.
double reference(double inner, double outer, double angle) {
  const double scale = 1.0 / std::max(0.001, std::cos(inner) - std::cos(outer));
  const double share = std::clamp((std::cos(angle) - std::cos(outer)) * scale, 0.0, 1.0);
  return share * share;
}

TEST(ConeShare, FollowsTheReferenceCode) {
  for (const auto& [inner, outer] : {std::pair{0.0, 0.785}, {0.2, 0.5}, {0.5, 1.5707}, {0.0, 0.1}}) {
    for (int i = 0; i <= 160; ++i) {
      const double angle = 0.02 * i;
      EXPECT_NEAR(cone_share(spot(inner, outer), away(angle)), reference(inner, outer, angle), 1e-12)
          << inner << ' ' << outer << ' ' << angle;
    }
  }
}

// Down to a thousandth of a degree: the axis keeps all of its light and half of the angle (3/4)^2.
TEST(ConeShare, NarrowConesKeepTheirShape) {
  for (const double outer : {0.02, 1e-3, 1.7e-5}) {
    EXPECT_EQ(cone_share(spot(0.0, outer), away(0.0)), 1.0);
    EXPECT_NEAR(cone_share(spot(0.0, outer), away(0.5 * outer)), 0.5625, 1e-4);
    EXPECT_EQ(cone_share(spot(0.0, outer), away(1.001 * outer)), 0.0);
  }
}

TEST(ConeShare, EqualAnglesAreAHardEdge) {
  EXPECT_EQ(cone_share(spot(0.3, 0.3), away(0.299)), 1.0);
  EXPECT_EQ(cone_share(spot(0.3, 0.3), away(0.301)), 0.0);
}

}  // namespace
}  // namespace raykiln::render
