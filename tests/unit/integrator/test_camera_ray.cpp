#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "raykiln/integrator/camera_ray.hpp"
#include "raykiln/math/float_bits.hpp"

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

}  // namespace
}  // namespace raykiln::render
