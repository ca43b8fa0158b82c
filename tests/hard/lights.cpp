// L01-L05: point lights on surfaces, at cameras, at hit points, faint, bright and edge-on.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "hard/support/members.hpp"
#include "hard/support/models.hpp"
#include "hard/support/report.hpp"
#include "hard/support/rules.hpp"
#include "raykiln/selftest/direct_light.hpp"
#include "raykiln/selftest/small_scene.hpp"

namespace raykiln::hard {
namespace {

using namespace render;
using namespace render::selftest;

constexpr double kPi = std::numbers::pi;

RenderSettings direct_only(int side, const LightModel& model, PixelMode mode = PixelMode::kRandom) {
  RenderSettings settings = square_settings(side, 0, model);
  settings.pixel_mode = mode;
  return settings;
}

/// Directions along which sums of dyadic numbers are exact: the axes, or an orthogonal triple of
/// integers of length 3. A point of a plane across the third one can then lie on it to the last bit.
struct ExactFrame {
  Vec3d u, v, w;
  double length;
  [[nodiscard]] Vec3d at(double a, double b, double c) const { return a * u + b * v + c * w; }
};

ExactFrame random_frame(Members& members) {
  const std::array<ExactFrame, 5> frames{
      {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, 1},
       {{0, 1, 0}, {0, 0, 1}, {1, 0, 0}, 1},
       {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}, 1},
       {{1, 2, 2}, {2, 1, -2}, {-2, 2, -1}, 3},
       {{2, -2, 1}, {1, 2, 2}, {-2, -1, 2}, 3}}};
  return frames[members.bits() % frames.size()];
}

double dyadic(Members& members, double low, double high, double step) {
  return std::round(members.between(low, high) / step) * step;
}

/// Square |a|, |b| <= half at height c of the frame, facing along w or against it.
void frame_square(SmallScene& s, const ExactFrame& f, double half, double c, bool up,
                  std::uint32_t material) {
  std::array<Vec3f, 4> p{Vec3f(f.at(-half, -half, c)), Vec3f(f.at(half, -half, c)),
                         Vec3f(f.at(half, half, c)), Vec3f(f.at(-half, half, c))};
  if (!up) std::swap(p[1], p[3]);
  s.quad(p, material);
}

struct Seen {
  std::uint64_t lit = 0, all = 0, non_finite = 0;
  double largest = 0.0;
};

/// One sample in each of side^2 pixels of what the camera sees.
Seen see(const Scene& scene, int side, const LightModel& model) {
  RenderStats stats;
  const Film film = render_film(scene, direct_only(side, model), 1, &stats);
  Seen seen;
  for (const double value : film.plane("largest")) {
    ++seen.all;
    seen.lit += value > 0.0 ? 1 : 0;
    seen.largest = std::max(seen.largest, value);
  }
  seen.non_finite = stats.non_finite;
  return seen;
}

// Between the ceiling and what lies below it, and between it and what lies above.
TEST(L01, PointLightLyingOnASurface) {
  Members members(1001);
  Row row("L01", "point light in the plane of a ceiling: inside a triangle, on an edge, on a corner; axis-parallel and oblique" +
                     members.note(),
          "ceiling 0; below all lit; above all lit or none; no NaN", "both");
  std::uint64_t receivers = 0, below = 0, above = 0, ceiling = 0, non_finite = 0, between = 0;
  const int cases = 12, side = static_cast<int>(std::sqrt(static_cast<double>(trials(1000000, 10000000)) / cases));
  for (int i = 0; i < cases; ++i) {
    const ExactFrame f = random_frame(members);
    const double height = dyadic(members, 0.25, 4.0, 0x1p-8), half = 4.0;
    const double gap = std::ldexp(1.0, -static_cast<int>(members.bits() % 6));
    double a = dyadic(members, -0.75, 0.75, 0x1p-8), b = dyadic(members, -0.75, 0.75, 0x1p-8);
    if (i % 3 == 1) b = a;         // on the diagonal, an edge of both triangles
    if (i % 3 == 2) a = b = half;  // on a corner
    const auto look_at = [&](double from, double to, bool at_ceiling) {
      SmallScene s;
      const auto white = s.material(matte(0.8F));
      frame_square(s, f, half, height, false, white);
      frame_square(s, f, 8.0, height - gap, true, white);
      frame_square(s, f, 8.0, height + gap, false, white);
      s.point_light(Vec3f(f.at(a, b, height)), Rgb(1.0F));
      const double view = at_ceiling ? 0.5 : 2.0;
      s.look(f.at(0.1, 0.2, from), f.at(0.1, 0.2, to), f.u, 2.0 * std::atan(view));
      return see(s.scene(), side, model_of(static_cast<std::size_t>(i / 3)));
    };
    const double inside = height - 0.5 * gap, over = height + 0.5 * gap;
    const Seen down = look_at(inside, height - gap, false), up = look_at(over, height + gap, false);
    const Seen under = look_at(inside, height, true), top = look_at(over, height, true);
    receivers += down.all;
    below += down.lit;
    above += up.lit;
    ceiling += under.lit + top.lit;
    between += up.lit != 0 && up.lit != up.all ? 1 : 0;
    non_finite += down.non_finite + up.non_finite + under.non_finite + top.non_finite;
    EXPECT_EQ(down.lit, down.all) << i;
    EXPECT_EQ(under.lit + top.lit, 0U) << i << ' ' << under.largest << ' ' << top.largest;
  }
  row.measured("receivers a side", receivers);
  row.measured("lit below", below);
  row.measured("lit above", above);
  row.measured("ceilings lit", ceiling);
  row.measured("non-finite", non_finite);
  EXPECT_EQ(between, 0U);
  EXPECT_EQ(non_finite, 0U);
}

TEST(L02, Headlight) {
  Members members(1002);
  Row row("L02", "point light at the camera" + members.note(), "a I cos/(pi r^2), 1e-5, at every angle", "both");
  double worst = 0.0;
  for (int i = 0; i < 200; ++i) {
    const double h = i == 0 ? 2.0 : members.scale(1e-3, 1e3), away = i == 0 ? 0.0 : h * members.between(0, 5);
    SmallScene s;
    s.level_square(static_cast<float>(20.0 * h), 0.0F, s.material(matte(0.8F)));
    s.look({away, 0, h}, {0, 0, 0}, {0, 1, 0}, 1e-6);
    s.point_light(Vec3f(s.scene().cameras[0].eye), Rgb(10.0F));
    const Measured m = measure(s.scene(), direct_only(1, model_of(static_cast<std::size_t>(i)), PixelMode::kCentre), 1);
    const double truth = 0.8 * 10.0 * h / kPi / std::pow(h * h + away * away, 1.5);
    worst = std::max(worst, relative_error(m.mean, truth));
    EXPECT_EQ(m.stats.non_finite, 0U);
  }
  row.measured("largest relative error", worst);
  EXPECT_LE(worst, 1e-5);
}

// The camera looks straight down at the light's own place, which the hit meets to the last bit.
TEST(L02, AtTheHitPoint) {
  Members members(1012);
  Row row("L02", "point light at a hit point to the last bit, at corners and inside" + members.note(),
          "contributes 0, is counted; finite", "both");
  std::uint64_t counted = 0, cases = 0;
  for (int i = 0; i < 200; ++i) {
    const double x = dyadic(members, -0.5, 0.5, 0x1p-6), y = dyadic(members, -0.5, 0.5, 0x1p-6);
    const bool corner = i % 2 == 0;
    SmallScene s;
    const auto white = s.material(matte(0.8F));
    const auto fx = static_cast<float>(x), fy = static_cast<float>(y);
    const Vec3f p(fx, fy, 0);
    if (corner) {
      s.triangle(p, {2, -2, 0}, {2, 2, 0}, white);
      s.triangle(p, {2, 2, 0}, {-2, 2, 0}, white);
      s.triangle(p, {-2, 2, 0}, {-2, -2, 0}, white);
      s.triangle(p, {-2, -2, 0}, {2, -2, 0}, white);
    } else {
      s.triangle({fx - 1, fy - 1, 0}, {fx + 1, fy - 1, 0}, {fx, fy + 1, 0}, white);
    }
    s.look({x, y, 1}, {x, y, 0}, {0, 1, 0}, 1e-6);
    s.point_light(p, Rgb(10.0F));
    const Measured m = measure(s.scene(), direct_only(1, model_of(static_cast<std::size_t>(i / 2)), PixelMode::kCentre), 1);
    ++cases;
    counted += m.stats.lights_at_hits;
    EXPECT_EQ(m.stats.non_finite, 0U);
    EXPECT_EQ(m.mean, 0.0);
  }
  row.never("not counted", cases - counted, cases);
  EXPECT_EQ(counted, cases);
}

TEST(L03, InverseSquareWithoutBound) {
  Row row("L03", "point light at h = 1, 1e-3, 1e-10, 1e-19, 1e-23 over the plane z = 0", "a I/(pi h^2) to 1e-5 while it fits; beyond dropped and counted", "both");
  double worst = 0.0;
  std::uint64_t dropped = 0;
  const std::array<double, 8> heights{1.0, 1e-3, 1e-6, 1e-10, 1e-15, 1e-19, 1e-23, 1e-38};
  for (std::size_t i = 0; i < 2 * heights.size(); ++i) {
    const double h = heights[i / 2];
    SmallScene s;
    s.triangle({0, 0, 0}, {1, -1, 0}, {1, 1, 0}, s.material(matte(0.8F)));
    s.triangle({0, 0, 0}, {1, 1, 0}, {-1, 1, 0}, 0);
    s.triangle({0, 0, 0}, {-1, 1, 0}, {-1, -1, 0}, 0);
    s.triangle({0, 0, 0}, {-1, -1, 0}, {1, -1, 0}, 0);
    s.look({0, 0, 1}, {0, 0, 0}, {0, 1, 0}, 1e-6);
    const auto height = static_cast<float>(h);
    s.point_light({0, 0, height}, Rgb(10.0F));
    const Measured m = measure(s.scene(), direct_only(1, model_of(i), PixelMode::kCentre), 1);
    const double truth = 0.8 * 10.0 / kPi / (static_cast<double>(height) * static_cast<double>(height));
    if (truth < static_cast<double>(std::numeric_limits<float>::max())) {
      worst = std::max(worst, relative_error(m.mean, truth));
      EXPECT_EQ(m.stats.non_finite, 0U) << h;
    } else {
      EXPECT_EQ(m.stats.non_finite, 1U) << h;
      EXPECT_EQ(m.samples, 0.0) << h;
      dropped += m.stats.non_finite;
    }
  }
  row.measured("largest relative error", worst);
  row.measured("dropped and counted", dropped);
  EXPECT_LE(worst, 1e-5);
  EXPECT_EQ(dropped, 4U);
}

TEST(L03, FluxThroughThePixelOfTheFoot) {
  Row row("L03", "mean over a square about the foot, h = 0.1, 0.03, 0.01 of its half-side", "(a/pi) I Omega/A, 4 sigma", "both");
  for (std::size_t i = 0; i < 6; ++i) {
    const double h = std::array{0.1, 0.03, 0.01}[i / 2];
    const auto outcome = light_over_square({.height = h, .distance = 1.0, .model = model_of(i)}, trials(16384, 1000000));
    EXPECT_TRUE(outcome.passed) << h << ' ' << outcome.measured;
    row.measured("", outcome.measured);
  }
}

SmallScene two_light_floor(const Rgb& intensity, const Rgb& emission) {
  SmallScene s;
  s.level_square(2.0F, 0.0F, s.material(matte(0.8F)));
  Material lamp = matte(0.0F);
  lamp.emission = emission;
  s.level_square(0.3F, 1.0F, s.material(lamp), false);
  s.point_light({0.7F, 0.2F, 0.9F}, intensity);
  s.look({0.1, 0.2, 0.9}, {0.1, 0.2, 0}, {0, 1, 0}, 1.8);
  return s;
}

TEST(L04, LinearOverTheRangeOfTheFormat) {
  Row row("L04", "intensity and emission times 2^k, k = -40 .. 40", "picture times 2^k bit for bit", "both");
  std::uint64_t different = 0, values = 0;
  for (const LightModel& model : kBothModels) {
    const auto picture = [&](float s) {
      return render_film(two_light_floor(Rgb(0.7F, 0.2F, 0.1F) * s, Rgb(0.3F, 0.5F, 0.9F) * s).scene(),
                         square_settings(8, 2, model), 8).plane("beauty");
    };
    const auto plain = picture(1.0F);
    EXPECT_GT(*std::max_element(plain.begin(), plain.end()), 0.0);
    for (int k = -40; k <= 40; ++k) {
      const auto other = picture(std::ldexp(1.0F, k));
      for (std::size_t i = 0; i < plain.size(); ++i, ++values) {
        different += std::ldexp(plain[i], k) != other[i] ? 1 : 0;
      }
    }
  }
  row.never("values that differ", different, values);
  EXPECT_EQ(different, 0U);
}

TEST(L04, LargestAndSmallestIntensities) {
  Row row("L04", "I = 1e38, 1e-38, 1e-45 (denormal), red only", "(a/pi) I h/r^3 to 1e-5 of the float that was given; finite", "both");
  double worst = 0.0;
  for (std::size_t i = 0; i < 6; ++i) {
    const float intensity = std::array{1e38F, 1e-38F, 1e-45F}[i / 2];
    SmallScene s;
    s.level_square(9.0F, 0.0F, s.material(matte(0.5F)));
    s.point_light({0, 0, 2}, {intensity, 0, 0});
    s.look({0.3, 0.2, 1}, {0, 0, 0}, {0, 1, 0}, 1e-6);
    RenderStats stats;
    const Film film = render_film(s.scene(), direct_only(1, model_of(i), PixelMode::kCentre), 16, &stats);
    const auto beauty = film.plane("beauty");
    worst = std::max(worst, relative_error(beauty[0] / 16.0, 0.5 / kPi * static_cast<double>(intensity) / 4.0));
    EXPECT_EQ(beauty[1], 0.0);
    EXPECT_EQ(beauty[2], 0.0);
    EXPECT_EQ(stats.non_finite, 0U);
  }
  row.measured("largest relative error", worst);
  EXPECT_LE(worst, 1e-5);
}

/// A light beside a patch and some ulps over or under its plane, seen from
/// `side` of it; the largest value in units of I/r^2. A `view` of 1e-6 rad sees one point.
double seen_from(const ExactFrame& f, double height, int ulps, double side, float transparent, const LightModel& model,
                 double view = 0.6) {
  SmallScene s;
  Material sheet = matte(0.8F);
  sheet.transparent = transparent;
  frame_square(s, f, 4.0, height, true, s.material(sheet));
  const Vec3d in_plane = f.at(1.5, 0.25, height);
  Vec3f light(in_plane);
  // One float coordinate moved by ulps, the one along which the plane's normal is largest.
  int axis = 0;
  for (int k = 1; k < 3; ++k) axis = std::abs(f.w[k]) > std::abs(f.w[axis]) ? k : axis;
  const float towards = f.w[axis] > 0.0 ? std::numeric_limits<float>::infinity() : -std::numeric_limits<float>::infinity();
  for (int k = 0; k < std::abs(ulps); ++k) {
    light[axis] = std::nextafterf(light[axis], ulps > 0 ? towards : -towards);
  }
  s.point_light(light, Rgb(10.0F));
  const Vec3d patch = f.at(-0.25, 0.125, height);
  s.look(patch + side / f.length * f.w, patch, f.u, view);
  RenderStats stats;
  const Film film = render_film(s.scene(), direct_only(16, model), 1, &stats);
  EXPECT_EQ(stats.non_finite, 0U);
  const auto values = film.plane("largest");
  const double r = length(in_plane - patch);
  return *std::max_element(values.begin(), values.end()) * r * r / 10.0;
}

TEST(L05, EdgeOnAndBehind) {
  Members members(1005);
  Row row("L05", "point light in the plane of a quad, 1 ulp above, 1 ulp below; opaque and translucent" + members.note(),
          "opaque: 0 at and behind, <= 1e-6 I/r^2 above; translucent: alike on both sides", "both");
  double in_plane = 0.0, behind = 0.0, front = 0.0, unequal = 0.0;
  for (int i = 0; i < 60; ++i) {
    const ExactFrame f = random_frame(members);
    const LightModel& model = model_of(static_cast<std::size_t>(i));
    const double height = dyadic(members, 0.5, 2.0, 0x1p-8);
    for (const double side : {1.0, -1.0}) {
      for (const float transparent : {0.0F, 1.0F}) {
        in_plane = std::max(in_plane, seen_from(f, height, 0, side, transparent, model));
      }
      const int facing = side > 0.0 ? 1 : -1;
      behind = std::max(behind, seen_from(f, height, -facing, side, 0.0F, model));
      front = std::max(front, seen_from(f, height, facing, side, 0.0F, model));
      // Where the plane's normal is an axis, doubles see the ulp and the cosine is right.
      if (f.length == 1.0) {
        EXPECT_GT(seen_from(f, height, facing, side, 0.0F, model), 0.0) << i;
      }
    }
    const double above = seen_from(f, height, 1, 1.0, 1.0F, model, 1e-6), far = seen_from(f, height, 1, -1.0, 1.0F, model, 1e-6);
    unequal = std::max(unequal, std::abs(above - far));
  }
  row.measured("in the plane", in_plane);
  row.measured("behind", behind);
  row.measured("1 ulp above, over I/r^2", front);
  row.measured("translucent sides differ by, over I/r^2", unequal);
  EXPECT_EQ(in_plane, 0.0);
  EXPECT_EQ(behind, 0.0);
  EXPECT_LE(front, 1e-6);
  EXPECT_LE(unequal, 1e-7);
}

}  // namespace
}  // namespace raykiln::hard
