#include <gtest/gtest.h>

#include <cmath>

#include "raykiln/integrator/camera_ray.hpp"

namespace raykiln::render {
namespace {

Camera wide_camera() {
  Camera camera;
  camera.fov_y_rad = 1.57079633F;
  return camera;
}

TEST(CameraRays, CornersAndCentre) {
  const CameraRays rays(wide_camera(), 200, 100);
  EXPECT_NEAR(length(rays.direction(100, 50) - Vec3f(0, 0, -1)), 0.0F, 1e-6F);
  // The vertical field of view is 90 degrees, the horizontal one follows from square pixels.
  EXPECT_NEAR(length(rays.direction(100, 0) - normalize(Vec3f(0, 1, -1))), 0.0F, 1e-6F);
  EXPECT_NEAR(length(rays.direction(0, 50) - normalize(Vec3f(-2, 0, -1))), 0.0F, 1e-6F);
  EXPECT_NEAR(length(rays.direction(200, 100) - normalize(Vec3f(2, -1, -1))), 0.0F, 1e-6F);
}

TEST(CameraRays, CentreModeIsTheMiddleAndRandomModeStaysInside) {
  const CameraRays rays(wide_camera(), 8, 8);
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

}  // namespace
}  // namespace raykiln::render
