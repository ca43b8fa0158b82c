#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <tuple>
#include <vector>

#include "raykiln/integrator/camera_ray.hpp"
#include "raykiln/math/float_bits.hpp"
#include "raykiln/sampling/warp.hpp"
#include "support/statistics.hpp"

namespace raykiln::render {
namespace {

const Bounds3f kUnitBox{Vec3f(-1.0F), Vec3f(1.0F)};

Camera wide_camera() {
  Camera camera;
  camera.fov_y_rad = 0.5 * std::numbers::pi;
  return camera;
}

TEST(CameraRays, CornersAndCentre) {
  const CameraRays rays(wide_camera(), 200, 100, kUnitBox);
  EXPECT_NEAR(length(rays.direction(100, 50) - Vec3f(0, 0, -1)), 0.0F, 1e-6F);
  // The vertical field of view is 90 degrees, the horizontal one follows from square pixels.
  EXPECT_NEAR(length(rays.direction(100, 0) - normalize(Vec3f(0, 1, -1))), 0.0F, 1e-6F);
  EXPECT_NEAR(length(rays.direction(0, 50) - normalize(Vec3f(-2, 0, -1))), 0.0F, 1e-6F);
  EXPECT_NEAR(length(rays.direction(200, 100) - normalize(Vec3f(2, -1, -1))), 0.0F, 1e-6F);
}

TEST(CameraRays, CentreModeIsTheMiddleAndRandomModeStaysInside) {
  const CameraRays rays(wide_camera(), 8, 8, kUnitBox);
  for (std::uint64_t i = 0; i < 1000; ++i) {
    const VertexKey key = vertex_key(path_key(1, i, 0), 0, 0);
    EXPECT_EQ(rays.ray(2, 5, PixelMode::kCentre, key).d, rays.direction(2.5, 5.5));
    const Vec3f d = rays.ray(2, 5, PixelMode::kRandom, key).d;
    const float x = 4.0F * (1.0F - d.x / d.z), y = 4.0F * (1.0F + d.y / d.z);
    EXPECT_GE(x, 2.0F - 1e-5F);
    EXPECT_LE(x, 3.0F + 1e-5F);
    EXPECT_GE(y, 5.0F - 1e-5F);
    EXPECT_LE(y, 6.0F + 1e-5F);
  }
}

Ray middle_ray(const CameraRays& rays) {
  return rays.ray(0, 0, PixelMode::kCentre, vertex_key(path_key(1, 0, 0), 0, 0));
}

TEST(CameraRays, AnEyeAmongTheGeometryStaysWhereItIs) {
  for (const Vec3d& eye : {Vec3d(0.0), Vec3d(0.3, -0.7, 0.9), Vec3d(1.0, -1.0, 1.0)}) {
    Camera camera = wide_camera();
    camera.eye = eye;
    const Ray ray = middle_ray(CameraRays(camera, 1, 1, kUnitBox));
    EXPECT_EQ(ray.o, Vec3f(eye));
    EXPECT_EQ(ray.t_max, std::numeric_limits<float>::infinity());
  }
}

// From any distance the ray runs through the point aimed at, to what a float of the geometry's size
// can say, and starts outside of the geometry.
TEST(CameraRays, FarEyesSeeAsSharplyAsNearOnes) {
  for (std::uint64_t i = 0; i < 2000; ++i) {
    const VertexKey key = vertex_key(path_key(7, i, 0), 0, 0);
    const auto number = [&](Dimension d) { return 2.0 * uniform(key, d) - 1.0; };
    const Vec3d target(number(Dimension::kPixelX), number(Dimension::kPixelY),
                       number(Dimension::kLightU));
    const Vec3d towards = normalize(Vec3d(number(Dimension::kLightV), number(Dimension::kLobeChoice),
                                          number(Dimension::kDirectionU)));
    const double distance = std::pow(10.0, 1.0 + 6.0 * uniform(key, Dimension::kDirectionV));
    Camera camera;
    camera.eye = target + distance * towards;
    camera.forward = -towards;
    camera.right = normalize(cross(camera.forward, Vec3d(0.31, 0.95, 0.02)));
    camera.up = cross(camera.right, camera.forward);
    const Ray ray = middle_ray(CameraRays(camera, 1, 1, kUnitBox));
    const Vec3d o(ray.o), d(ray.d);
    const Vec3d off = target - o - dot(target - o, d) / dot(d, d) * d;
    EXPECT_LE(length(off), 8.0 * kFloatUnit + 0x1p-51 * distance) << distance;
    const Vec3f away = abs(ray.o);
    EXPECT_GT(std::max({away.x, away.y, away.z}), 1.0F);
    EXPECT_LE(length(ray.o), 1.7321F);
  }
}

TEST(CameraRays, WhatPassesTheGeometryByMeetsNothing) {
  Camera camera = wide_camera();
  for (const Vec3d& eye : {Vec3d(2.0, 0.0, 9.0), Vec3d(0.0, 1e9, 9.0), Vec3d(0.0, 0.0, -2.0)}) {
    camera.eye = eye;
    EXPECT_EQ(middle_ray(CameraRays(camera, 1, 1, kUnitBox)).t_max, 0.0F);
  }
  camera.eye = Vec3d(0.0);
  EXPECT_EQ(middle_ray(CameraRays(camera, 1, 1, Bounds3f{})).t_max, 0.0F);
}

TEST(CameraRays, OrthographicOnesAreParallelAndCoverTheRectangle) {
  Camera camera = wide_camera();
  camera.projection = Projection::kOrthographic;
  camera.view_height = 4.0;
  camera.eye = Vec3d(0.0, 0.0, 0.5);
  const CameraRays rays(camera, 8, 4, {Vec3f(-9.0F), Vec3f(9.0F)});
  const VertexKey key = vertex_key(path_key(1, 0, 0), 0, 0);
  for (const auto& [x, y, at] : {std::tuple{0, 0, Vec3f(-3.5F, 1.5F, 0.5F)}, {7, 3, Vec3f(3.5F, -1.5F, 0.5F)}}) {
    const Ray ray = rays.ray(x, y, PixelMode::kCentre, key);
    EXPECT_EQ(ray.o, at) << "starts among the geometry, at its own place";
    EXPECT_EQ(ray.d, Vec3f(0, 0, -1));
  }
  camera.eye.z = 1e6;  // from far off: just before the geometry
  const Ray far = CameraRays(camera, 8, 4, kUnitBox).ray(4, 2, PixelMode::kCentre, key);
  EXPECT_NEAR(far.o.z, 1.0F, 1e-6F);
  EXPECT_EQ(Vec3f(far.o.x, far.o.y, 0.0F), Vec3f(0.5F, -0.5F, 0.0F));
}

/// Where a ray meets the plane `depth` in front of wide_camera().
Vec3d at_depth(const Ray& ray, double depth) {
  const Vec3d o(ray.o), d(ray.d);
  return o + (-depth - o.z) / d.z * d;
}

// Rays of one point of the picture meet in the plane of focus; at depth z they fill a disk of radius
// R |z - f| / f about the ray through the middle, evenly.
TEST(CameraRays, TheCircleOfConfusionIsThatOfAThinLens) {
  constexpr double kRadius = 0.05, kFocus = 3.0;
  for (const Projection projection : {Projection::kPerspective, Projection::kOrthographic}) {
    Camera camera = wide_camera();
    camera.projection = projection;
    camera.view_height = 2.0;
    const Bounds3f everywhere{Vec3f(-99.0F), Vec3f(99.0F)};
    const CameraRays pinhole(camera, 16, 8, everywhere);
    camera.lens = {.radius = kRadius, .focus_distance = kFocus};
    const CameraRays rays(camera, 16, 8, everywhere);
    for (const double z : {0.5, kFocus, 12.0}) {
      constexpr int kRays = 4000, kRings = 10;
      const double blur = kRadius * std::abs(z - kFocus) / kFocus;
      std::vector<double> seen(4 * kRings, 0.0), expected(4 * kRings, kRays / (4.0 * kRings));
      for (std::uint64_t i = 0; i < kRays; ++i) {
        const VertexKey key = vertex_key(path_key(3, i, 0), 0, 0);
        const Vec3d off = at_depth(rays.ray(13, 1, PixelMode::kCentre, key), z) -
                          at_depth(pinhole.ray(13, 1, PixelMode::kCentre, key), z);
        ASSERT_LE(length(off), blur + 1e-5) << z;
        if (blur == 0.0) continue;
        const double ring = std::min(kRings - 1.0, std::floor(kRings * dot(off, off) / (blur * blur)));
        seen[static_cast<std::size_t>(4.0 * ring) + (off.x > 0.0 ? 1U : 0U) + (off.y > 0.0 ? 2U : 0U)] += 1.0;
      }
      if (blur == 0.0) continue;
      EXPECT_GT(support::chi_square_p(seen, expected), support::sidak_level(4)) << z;
    }
  }
}

// The window by its own definition, summed up numerically.
TEST(PixelFilter, DrawsBlackmanHarris) {
  constexpr int kSteps = 30000;
  double total = 0.0, squares = 0.0, fourth = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double t = (i + 0.5) / kSteps, x = 3.0 * (t - 0.5);
    const double w = 0.35875 - 0.48829 * std::cos(2 * kPi * t) + 0.14128 * std::cos(4 * kPi * t) -
                     0.01168 * std::cos(6 * kPi * t);
    total += w;
    squares += w * x * x;
    fourth += w * x * x * x * x;
  }
  double drawn_squares = 0.0, drawn_fourth = 0.0, before = -1.0;
  for (int i = 0; i < kSteps; ++i) {
    const double x = filtered_offset(PixelFilter::kBlackmanHarris, (i + 0.5) / kSteps) - 0.5;
    EXPECT_GT(x, before - 0.5) << "rises";
    before = x + 0.5;
    drawn_squares += x * x / kSteps;
    drawn_fourth += x * x * x * x / kSteps;
  }
  EXPECT_NEAR(drawn_squares, squares / total, 1e-5);
  EXPECT_NEAR(drawn_fourth, fourth / total, 1e-5);
  EXPECT_NEAR(filtered_offset(PixelFilter::kBlackmanHarris, 0.5), 0.5, 1e-11);
  EXPECT_GE(filtered_offset(PixelFilter::kBlackmanHarris, 0.0), -1.0);
  EXPECT_LE(filtered_offset(PixelFilter::kBlackmanHarris, 1.0 - 0x1p-53), 2.0);
  EXPECT_EQ(filtered_offset(PixelFilter::kBox, 0.3), 0.3);
}

}  // namespace
}  // namespace raykiln::render
