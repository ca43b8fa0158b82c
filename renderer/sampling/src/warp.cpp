#include "raykiln/sampling/warp.hpp"

#include <algorithm>
#include <cmath>

#include "raykiln/math/frame.hpp"
#include "raykiln/sampling/turn_series.hpp"

namespace raykiln::render {
namespace {

struct Turn {
  double cosine, sine;
};

/// Cosine and sine of 2 pi v, v in [0, 1], to an ulp or two, by operations that a vector unit has as well.
Turn turn(double v) {
  const double quarter = (4.0 * v + turn_series::kToInteger) - turn_series::kToInteger;
  const double x = 2.0 * kPi * (v - 0.25 * quarter);
  const double x2 = x * x;
  double s = turn_series::kSine[0], c = turn_series::kCosine[0];
  for (int k = 1; k < turn_series::kTerms; ++k) {
    s = s * x2 + turn_series::kSine[k];
    c = c * x2 + turn_series::kCosine[k];
  }
  s = x + x * (x2 * s);
  c = 1.0 + x2 * c;
  if (quarter == 1.0) return {-s, c};
  if (quarter == 2.0) return {-c, -s};
  if (quarter == 3.0) return {s, -c};
  return {c, s};
}

}  // namespace

double one_minus_cos(const Vec3f& a, const Vec3f& b) {
  const Vec3d difference = Vec3d(a) - Vec3d(b);
  return 0.5 * dot(difference, difference);
}

double sample_one_minus_cos(double u, double exponent) {
  return std::min(-std::expm1(std::log1p(-u) / (exponent + 1.0)), 1.0 - 0x1p-53);
}

double sample_cosine_one_minus_cos(double u) { return u / (1.0 + std::sqrt(1.0 - u)); }

double cosine_power_pdf(double x, double exponent) {
  if (!(x < 1.0)) return 0.0;
  const double power = exponent == 0.0 ? 1.0 : std::exp(exponent * std::log1p(-x));
  return (exponent + 1.0) / (2.0 * kPi) * power;
}

Vec3f around_axis(const Vec3f& axis, double x, double v) {
  const Frame frame(axis);
  const double sine = std::sqrt(x * (2.0 - x));
  const Turn angle = turn(v);
  // In double and rounded once: at exponent 1e12 the sine is no more than a few float ulp of 1.
  return Vec3f(sine * angle.cosine * Vec3d(frame.s) + sine * angle.sine * Vec3d(frame.t) +
               (1.0 - x) * Vec3d(frame.n));
}

Vec3f sample_uniform_sphere(double u, double v) {
  const double z = 1.0 - 2.0 * u;
  const double sine = 2.0 * std::sqrt(u * (1.0 - u));
  const double phi = 2.0 * kPi * v;
  return Vec3f(Vec3d(sine * std::cos(phi), sine * std::sin(phi), z));
}

DiskPoint sample_uniform_disk(double u, double v) {
  const double a = 2.0 * u - 1.0, b = 2.0 * v - 1.0;
  if (a == 0.0 && b == 0.0) return {};
  const bool wide = std::abs(a) > std::abs(b);
  const double radius = wide ? a : b;
  const double angle = wide ? 0.25 * kPi * (b / a) : 0.5 * kPi - 0.25 * kPi * (a / b);
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

TrianglePoint sample_uniform_triangle(double u, double v) {
  const double root = std::sqrt(u);
  return {.b1 = root * (1.0 - v), .b2 = root * v};
}

}  // namespace raykiln::render
