// Polygons to triangles, by area and by sign.
#include "triangulate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace raykiln::render::io {
namespace {

double signed_area(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  return 0.5 * cross(b - a, c - a).z;
}

// Star-shaped around the origin, so simple, but with any number of notches.
std::vector<Vec3d> random_star(std::mt19937& random, std::size_t n) {
  std::uniform_real_distribution<double> radius(0.1, 3.0);
  std::vector<Vec3d> corners;
  for (std::size_t i = 0; i < n; ++i) {
    const double angle = 2.0 * 3.14159265358979 * static_cast<double>(i) / static_cast<double>(n);
    const double r = radius(random);
    corners.emplace_back(r * std::cos(angle), r * std::sin(angle), 0.0);
  }
  return corners;
}

TEST(Triangulate, SimplePolygonsAreTiledWithoutOverlap) {
  std::mt19937 random(7);
  for (int round = 0; round < 300; ++round) {
    const std::size_t n = 4 + static_cast<std::size_t>(round) % 60;
    const std::vector<Vec3d> corners = random_star(random, n);
    std::vector<std::array<std::uint32_t, 3>> pieces;
    ASSERT_EQ(triangulate(corners, pieces), PolygonStatus::kGood) << "round " << round;
    ASSERT_EQ(pieces.size(), n - 2);
    double whole = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      whole += signed_area(Vec3d(0.0), corners[i], corners[(i + 1) % n]);
    }
    double sum = 0.0;
    for (const auto& t : pieces) {
      const double piece = signed_area(corners[t[0]], corners[t[1]], corners[t[2]]);
      EXPECT_GE(piece, -1e-12) << "round " << round;  // a flipped piece would hide an overlap
      sum += piece;
    }
    EXPECT_NEAR(sum, whole, 1e-9) << "round " << round;
  }
}

TEST(Triangulate, AnyPlaneAndWindingKeepsTheNormal) {
  const std::vector<Vec3d> arrow{{0, 0, 0}, {2, -1, 0}, {1, 0, 0}, {2, 1, 0}};
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {1.0, -1.0}) {
      std::vector<Vec3d> corners;
      for (const Vec3d& p : arrow) {
        Vec3d q(0.0);
        q[axis] = p.x;
        q[(axis + 1) % 3] = sign * p.y;
        q += Vec3d(1e6, -2e6, 3e6);
        corners.push_back(q);
      }
      std::vector<std::array<std::uint32_t, 3>> pieces;
      ASSERT_EQ(triangulate(corners, pieces), PolygonStatus::kGood);
      for (const auto& t : pieces) {
        const Vec3d n = cross(corners[t[1]] - corners[t[0]], corners[t[2]] - corners[t[0]]);
        EXPECT_GT(sign * n[(axis + 2) % 3], 0.0);
      }
    }
  }
}

TEST(Triangulate, FlatPolygonsStillGiveTheRightNumber) {
  const std::vector<Vec3d> corners(7, Vec3d(1.0));
  std::vector<std::array<std::uint32_t, 3>> pieces;
  (void)triangulate(corners, pieces);
  EXPECT_EQ(pieces.size(), 5U);
}

}  // namespace
}  // namespace raykiln::render::io
