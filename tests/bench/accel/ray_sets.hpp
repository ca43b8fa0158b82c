// Rays of a picture for benchmarks of the walks: primary ones, shadow rays and diffuse bounces.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "raykiln/accel/kdtree.hpp"
#include "raykiln/math/frame.hpp"
#include "support/mesh_generators.hpp"

namespace raykiln::bench {

/// Jittered pinhole outside the box looking at its middle, `image` pixels a side, in tiles of 8 x 8.
inline std::vector<render::Ray> primary_rays(const render::Bounds3f& box, std::uint32_t image,
                                             std::uint64_t seed) {
  test::TestRandom random(seed);
  const render::Vec3f centre = (box.lo + box.hi) * 0.5F;
  const float radius = 0.5F * render::length(box.hi - box.lo);
  const render::Vec3f eye = centre + radius * render::Vec3f(1.1F, -1.3F, 1.2F);
  const render::Frame frame(render::normalize(centre - eye));
  std::vector<render::Ray> rays;
  const std::uint32_t tiles = std::max(1U, image / 8);
  for (std::uint32_t tile = 0; tile < tiles * tiles; ++tile) {
    for (std::uint32_t pixel = 0; pixel < 64; ++pixel) {
      const auto x = static_cast<float>(tile % tiles * 8 + pixel % 8);
      const auto y = static_cast<float>(tile / tiles * 8 + pixel / 8);
      const auto scale = 1.0F / static_cast<float>(tiles * 8);
      const float px = (x + random.uniform()) * scale - 0.5F;
      const float py = (y + random.uniform()) * scale - 0.5F;
      render::Ray ray;
      ray.o = eye;
      ray.d = frame.to_world({px, py, 1.1F});
      rays.push_back(ray);
    }
  }
  return rays;
}

struct SurfacePoint {
  render::Vec3f position, normal;  ///< the normal on the side where the ray came from
};

/// Where rays met something, lifted off the surface by more than floats round there.
inline std::vector<SurfacePoint> surface_points(const test::TestMesh& mesh,
                                                const std::vector<render::Ray>& rays,
                                                const std::vector<render::Hit>& hits) {
  std::vector<SurfacePoint> points;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    if (hits[i].id == render::kNoHit) continue;
    const auto p = mesh.corners(hits[i].id);
    render::Vec3f n = render::normalize(render::cross(p[1] - p[0], p[2] - p[0]));
    if (render::dot(n, rays[i].d) > 0.0F) n = -n;
    if (!(render::dot(n, n) > 0.5F)) continue;
    const render::Vec3f at =
        p[0] * (1.0F - hits[i].u - hits[i].v) + p[1] * hits[i].u + p[2] * hits[i].v;
    const float largest = std::max({1.0F, std::abs(at.x), std::abs(at.y), std::abs(at.z)});
    points.push_back({at + n * (1e-5F * largest), n});
  }
  return points;
}

/// One ray a point, distributed by the cosine.
inline std::vector<render::Ray> cosine_bounces(const std::vector<SurfacePoint>& points,
                                               std::uint64_t seed) {
  test::TestRandom random(seed);
  std::vector<render::Ray> rays;
  for (const SurfacePoint& point : points) {
    const float r = std::sqrt(random.uniform());
    const float phi = 2.0F * std::numbers::pi_v<float> * random.uniform();
    const render::Vec3f local(r * std::cos(phi), r * std::sin(phi), std::sqrt(1.0F - r * r));
    render::Ray ray;
    ray.o = point.position;
    ray.d = render::Frame(point.normal).to_world(local);
    rays.push_back(ray);
  }
  return rays;
}

/// One ray a point to a square light of a tenth of the box, above it; the light is at t = 1.
inline std::vector<render::Ray> shadow_rays(const std::vector<SurfacePoint>& points,
                                            const render::Bounds3f& box, std::uint64_t seed) {
  test::TestRandom random(seed);
  const render::Vec3f size = box.hi - box.lo;
  const render::Vec3f corner = box.hi + size * render::Vec3f(-0.35F, -0.65F, 0.5F);
  std::vector<render::Ray> rays;
  for (const SurfacePoint& point : points) {
    const float x = 0.1F * random.uniform();
    const float y = 0.1F * random.uniform();
    render::Ray ray;
    ray.o = point.position;
    ray.d = corner + size * render::Vec3f(x, y, 0.0F) - point.position;
    ray.t_max = 1.0F;
    rays.push_back(ray);
  }
  return rays;
}

}  // namespace raykiln::bench
