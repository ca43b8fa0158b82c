#include "raykiln/integrator/camera_ray.hpp"

#include <cmath>

namespace raykiln::render {

CameraRays::CameraRays(const Camera& camera, int width, int height) : eye_(camera.eye) {
  const double pixel = 2.0 * std::tan(0.5 * static_cast<double>(camera.fov_y_rad)) / height;
  step_x_ = pixel * Vec3d(camera.right);
  step_y_ = -pixel * Vec3d(camera.up);
  corner_ = Vec3d(camera.forward) - 0.5 * width * step_x_ - 0.5 * height * step_y_;
}

Vec3f CameraRays::direction(double x, double y) const {
  return Vec3f(normalize(corner_ + x * step_x_ + y * step_y_));
}

Ray CameraRays::ray(int x, int y, PixelMode mode, const VertexKey& vertex) const {
  const bool random = mode == PixelMode::kRandom;
  const double dx = random ? uniform(vertex, Dimension::kPixelX) : 0.5;
  const double dy = random ? uniform(vertex, Dimension::kPixelY) : 0.5;
  Ray ray;
  ray.o = eye_;
  ray.d = direction(x + dx, y + dy);
  return ray;
}

}  // namespace raykiln::render
