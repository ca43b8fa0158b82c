#include <gtest/gtest.h>

#include <cmath>

#include "raykiln/sampling/random.hpp"
#include "raykiln/sampling/warp.hpp"
#include "raykiln/shading/surface_point.hpp"

namespace raykiln::render {
namespace {

TriangleMesh one_triangle(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  TriangleMesh mesh;
  mesh.positions = {a, b, c};
  mesh.triangles = {{0, 1, 2}};
  mesh.material_ids = {0};
  return mesh;
}

TEST(SurfacePoint, PositionAndNormal) {
  const TriangleMesh mesh = one_triangle({0, 0, 2}, {4, 0, 2}, {0, 4, 2});
  const SurfacePoint point = surface_point(mesh, 0, 0.25, 0.5);
  EXPECT_EQ(point.p, Vec3d(1.0, 2.0, 2.0));
  EXPECT_EQ(point.ng, Vec3d(0.0, 0.0, 1.0));
  EXPECT_EQ(point.ns, Vec3f(0.0F, 0.0F, 1.0F));
}

TEST(SurfacePoint, InterpolatesNormalsWhereAllCornersHaveOne) {
  TriangleMesh mesh = one_triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  mesh.normals = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.corner_normals = {{0, 1, 2}};
  const Vec3f ns = surface_point(mesh, 0, 1.0 / 3.0, 1.0 / 3.0).ns;
  EXPECT_NEAR(ns.x, 1.0F / std::sqrt(3.0F), 1e-6F);
  EXPECT_EQ(surface_point(mesh, 0, 1.0, 0.0).ns, Vec3f(0, 1, 0));
  mesh.corner_normals = {{0, kNoNormal, 2}};
  EXPECT_EQ(surface_point(mesh, 0, 0.3, 0.3).ns, Vec3f(0, 0, 1));
  mesh.normals = {{0, 0, 1}, {0, 0, -1}, {0, 0, 1}};
  mesh.corner_normals = {{0, 1, 2}};
  EXPECT_EQ(surface_point(mesh, 0, 0.5, 0.25).ns, Vec3f(0, 0, 1));  // they cancel: fall back
}

/// Random triangle with coordinates of size 10^U(-8, 8), as numbered.
TriangleMesh random_triangle(std::uint64_t i) {
  std::uint64_t count = 0;
  const auto number = [&] {
    return uniform(vertex_key(path_key(5, i, count++), 0, 0), Dimension::kEnvironmentU);
  };
  const auto coordinate = [&] {
    const double size = std::pow(10.0, 16.0 * number() - 8.0);
    return static_cast<float>(number() < 0.5 ? -size : size);
  };
  const auto vertex = [&] {
    const float x = coordinate(), y = coordinate(), z = coordinate();
    return Vec3f(x, y, z);
  };
  const Vec3f a = vertex(), b = vertex(), c = vertex();
  return one_triangle(a, b, c);
}

/// Signed distance of the ray origin from the triangle's plane, in double on the float origin.
double height(const TriangleMesh& mesh, const SurfacePoint& point, const Vec3f& origin) {
  return dot(point.ng, Vec3d(origin) - Vec3d(mesh.positions[0]));
}

TEST(SurfacePoint, OriginsLieOnTheSideOfTheirDirection) {
  for (std::uint64_t i = 0; i < 5000; ++i) {
    const TriangleMesh mesh = random_triangle(i);
    const VertexKey key = vertex_key(path_key(6, i, 0), 0, 0);
    const TrianglePoint b = sample_uniform_triangle(uniform(key, Dimension::kLightU),
                                                    uniform(key, Dimension::kLightV));
    const SurfacePoint point = surface_point(mesh, 0, static_cast<double>(static_cast<float>(b.b1)),
                                             static_cast<double>(static_cast<float>(b.b2)));
    EXPECT_GT(height(mesh, point, ray_origin(point, point.ng)), 0.0) << i;
    EXPECT_LT(height(mesh, point, ray_origin(point, -point.ng)), 0.0) << i;
    EXPECT_LE(std::abs(height(mesh, point, ray_origin(point, point.ng))), 4.0 * point.clearance) << i;
  }
}

TEST(SurfacePoint, ClearanceIsNotZeroInACoordinatePlane) {
  const SurfacePoint point =
      surface_point(one_triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}), 0, 0.25, 0.25);
  EXPECT_GT(ray_origin(point, {0, 0, 1}).z, 1e-8F);
  EXPECT_LT(ray_origin(point, {0, 0, -1}).z, -1e-8F);
}

TEST(SurfacePoint, ScalesExactlyByPowersOfTwo) {
  const Vec3f a(0.3F, 1.7F, -2.0F), b(1.9F, -0.2F, 0.4F), c(0.1F, 0.6F, 1.1F);
  const SurfacePoint one = surface_point(one_triangle(a, b, c), 0, 0.3, 0.2);
  for (const int k : {-30, -10, 10, 30}) {
    const float s = std::ldexp(1.0F, k);
    const SurfacePoint scaled = surface_point(one_triangle(s * a, s * b, s * c), 0, 0.3, 0.2);
    EXPECT_EQ(scaled.ng, one.ng);
    EXPECT_EQ(ray_origin(scaled, one.ng), s * ray_origin(one, one.ng));
  }
}

}  // namespace
}  // namespace raykiln::render
