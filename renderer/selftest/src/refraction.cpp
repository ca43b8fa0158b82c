#include "raykiln/selftest/refraction.hpp"

#include <array>
#include <cmath>

#include "raykiln/selftest/small_scene.hpp"

namespace raykiln::render::selftest {
namespace {

constexpr double kHalfWidth = 1e-5;  ///< of the narrow emitter, rad

/// A triangular prism along y whose apex is at the origin, pointing up the z axis.
void add_prism(SmallScene& s, double apex_rad, std::uint32_t glass) {
  const auto x = static_cast<float>(4.0 * std::sin(0.5 * apex_rad)),
             z = static_cast<float>(-4.0 * std::cos(0.5 * apex_rad));
  const Vec3f a0(0, -4, 0), a1(0, 4, 0), l0(-x, -4, z), l1(-x, 4, z), r0(x, -4, z), r1(x, 4, z);
  s.quad({a0, a1, l1, l0}, glass);
  s.quad({a0, r0, r1, a1}, glass);
  s.quad({l0, l1, r1, r0}, glass);
  s.triangle(a0, l0, r0, glass);
  s.triangle(a1, r1, l1, glass);
}

}  // namespace

// At minimum deviation the path inside is level: it enters the left face at height z and leaves the
// right one at the same height, turned down by half of delta at each face.
Outcome prism_deviation(double index, double apex_rad, std::uint64_t samples) {
  const double delta = 2.0 * std::asin(index * std::sin(0.5 * apex_rad)) - apex_rad;
  const double z = -2.0 * std::cos(0.5 * apex_rad), x = 2.0 * std::sin(0.5 * apex_rad);
  const Vec3d in(std::cos(0.5 * delta), 0, std::sin(0.5 * delta));
  const Vec3d out(in.x, 0, -in.z), across(out.z, 0, -out.x);
  const double distance = 64.0;
  const auto view = [&](double half) {
    SmallScene s;
    add_prism(s, apex_rad, s.material(clear_glass(static_cast<float>(index))));
    const Vec3d centre = Vec3d(x, 0, z) + distance * out, u = half * distance * across,
                v(0, 0.05 * distance, 0);
    s.quad({Vec3f(centre - u - v), Vec3f(centre + u - v), Vec3f(centre + u + v), Vec3f(centre - u + v)},
           s.material(matte(0.0F, 1.0F)));
    s.look(Vec3d(-x, 0, z) - 8.0 * in, Vec3d(-x, 0, z), {0, 1, 0}, 1e-9);
    RenderSettings settings;
    settings.width = settings.height = 1;
    settings.max_depth = 2;
    settings.emitter_sampling = false;
    return measure(s.scene(), settings, samples);
  };
  const Measured wide = view(0.02), narrow = view(kHalfWidth);
  const bool all = wide.mean == narrow.mean && wide.contributions >= 30.0;
  return {all, "share of paths within 1e-5 rad: " + text(narrow.mean / wide.mean) + " of " +
                   text(std::round(wide.contributions)) + "; deviation " +
                   text(delta * 57.295779513082321) + " degrees"};
}

double slab_shift(double index, double angle_rad) {
  const double sine = std::sin(angle_rad);
  return sine * (1.0 - std::cos(angle_rad) / std::sqrt(index * index - sine * sine));
}

// Looking along x at a slab turned by the angle; the backdrop's edge stands where the middle of the
// picture should see it. Half of the paths that pass, to a quarter of one of 16 pixels.
Outcome slab_displacement(double index, double angle_rad, std::uint64_t samples) {
  constexpr int kPixels = 16;
  constexpr double kView = 0.02;  ///< width of the picture at the backdrop, in thicknesses
  const double eye = 200.0, behind = 100.0;
  const Vec3d n(-std::cos(angle_rad), std::sin(angle_rad), 0), side(n.y, -n.x, 0), up(0, 0, 1);
  // The viewing direction is (1, 0, 0): a slab turned by a positive angle shifts the ray downwards.
  const double edge = -slab_shift(index, angle_rad);
  const auto view = [&](double lowest) {
    SmallScene s;
    const auto glass = s.material(clear_glass(static_cast<float>(index)));
    const double w = 20.0;
    const auto face = [&](double depth, bool front) {
      const Vec3d c = -depth * n;
      std::array<Vec3f, 4> p{Vec3f(c - w * side - w * up), Vec3f(c + w * side - w * up),
                             Vec3f(c + w * side + w * up), Vec3f(c - w * side + w * up)};
      const Vec3f faced = cross(p[1] - p[0], p[2] - p[0]);
      if ((dot(Vec3d(faced), n) > 0.0) != front) std::swap(p[1], p[3]);
      s.quad(p, glass);
    };
    face(0.0, true);
    face(1.0, false);
    const auto y0 = static_cast<float>(lowest), far = static_cast<float>(behind);
    s.quad({Vec3f(far, y0, -50), {far, 50, -50}, {far, 50, 50}, {far, y0, 50}},
           s.material(matte(0.0F, 1.0F)));
    s.look({-eye, 0, 0}, {0, 0, 0}, up, kView / (eye + behind));
    RenderSettings settings;
    settings.width = settings.height = kPixels;
    settings.max_depth = 2;
    settings.emitter_sampling = false;
    return measure(s.scene(), settings, samples);
  };
  const Measured all = view(-50.0), half = view(edge);
  const double share = half.mean / all.mean, passed = all.mean * all.samples;
  const double offset = (share - 0.5) * kPixels;
  const double noise = 4.0 * 0.5 / std::sqrt(passed) * kPixels;
  return {std::abs(offset) <= 0.25 && noise <= 0.25 && half.contributions >= 30.0,
          "edge off by " + text(offset) + " pixels (4 sigma " + text(noise) + "), shift " +
              text(slab_shift(index, angle_rad))};
}

}  // namespace raykiln::render::selftest
