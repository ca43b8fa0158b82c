#include "raykiln/selftest/coverage.hpp"

#include <array>
#include <cmath>
#include <vector>

#include "raykiln/selftest/small_scene.hpp"

namespace raykiln::render::selftest {

// Clips the square (Sutherland & Hodgman 1974) and takes the area of what is left.
double covered_area(const HalfPlane& h) {
  const std::vector<std::array<double, 2>> square{{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  std::vector<std::array<double, 2>> kept;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto &p = square[i], &q = square[(i + 1) % 4];
    const double dp = h.c - h.a * p[0] - h.b * p[1], dq = h.c - h.a * q[0] - h.b * q[1];
    if (dp > 0.0) kept.push_back(p);
    if ((dp > 0.0) != (dq > 0.0)) {
      const double t = dp / (dp - dq);
      kept.push_back({p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])});
    }
  }
  double twice = 0.0;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const auto &p = kept[i], &q = kept[(i + 1) % kept.size()];
    twice += p[0] * q[1] - q[0] * p[1];
  }
  return 0.5 * std::abs(twice);
}

// Pixel (x, y) lies at (x, -y) of the plane z = 0; the camera looks down on it.
Scene half_plane_scene(const HalfPlane& h, int width, int height) {
  SmallScene s;
  const double norm = std::hypot(h.a, h.b), size = 8.0 * (width + height + std::abs(h.c) / norm);
  const Vec3d into(-h.a / norm, h.b / norm, 0), along(-into.y, into.x, 0);
  const Vec3d foot = -h.c / norm * into;
  s.quad({Vec3f(foot + size * along), Vec3f(foot + size * (into + along)),
          Vec3f(foot + size * (into - along)), Vec3f(foot - size * along)},
         s.material(matte(0.0F, 1.0F)));
  const double eye = 2.0 * height;
  s.look({0.5 * width, -0.5 * height, eye}, {0.5 * width, -0.5 * height, 0}, {0, 1, 0},
         2.0 * std::atan(0.5 * height / eye));
  return s.scene();
}

Outcome pixel_coverage(const HalfPlane& h, std::uint64_t samples) {
  RenderSettings settings;
  settings.width = settings.height = 1;
  settings.max_depth = 0;
  const double area = covered_area(h), truth = area * (1.0 - area);
  const Measured m = measure(half_plane_scene(h, 1, 1), settings, samples);
  Outcome outcome = statistically(m, area, 2e-6);
  const double variance = m.standard_error * m.standard_error * m.samples;
  // Fourth moment of a Bernoulli variable: Var(s^2) = pq (1 - 4pq)/n + O(1/n^2).
  const double spread = 4.0 * std::sqrt(truth * std::abs(1.0 - 4.0 * truth) / m.samples) +
                        4.0 / m.samples;
  outcome.passed = outcome.passed && std::abs(variance - truth) <= spread;
  outcome.measured += "; variance " + text(variance) + " against " + text(truth);
  return outcome;
}

}  // namespace raykiln::render::selftest
