// Maps from the unit square to directions and points, with their densities.
// Lobes carry x = 1 - cos instead of cos: a float cosine has one value left at exponent 1e9.
#pragma once

#include "raykiln/math/vec.hpp"

namespace raykiln::render {

inline constexpr double kPi = 3.14159265358979323846;

/// 1 - cos of the angle between two unit vectors, without cancellation: |a - b|^2 / 2.
[[nodiscard]] double one_minus_cos(const Vec3f& a, const Vec3f& b);

/// 1 - cos of a direction with density (e + 1)/(2 pi) cos^e about an axis: 1 - (1 - u)^(1/(e + 1)),
/// by log1p and expm1. u in [0, 1), e >= 0. The result is in [0, 1).
[[nodiscard]] double sample_one_minus_cos(double u, double exponent);

/// The same for the cosine itself, density cos/pi: x = u/(1 + sqrt(1 - u)), without log and exp.
[[nodiscard]] double sample_cosine_one_minus_cos(double u);

/// The density of a cosine power over solid angle, from 1 - cos; 0 where cos <= 0, whatever the exponent.
[[nodiscard]] double cosine_power_pdf(double one_minus_cos, double exponent);

/// The unit vector at 1 - cos from the unit axis, turned about it by 2 pi v.
[[nodiscard]] Vec3f around_axis(const Vec3f& axis, double one_minus_cos, double v);

/// Uniform on the unit sphere; density 1/(4 pi).
[[nodiscard]] Vec3f sample_uniform_sphere(double u, double v);
inline constexpr double kUniformSpherePdf = 0.25 / kPi;

/// Uniform in the disk of radius 1, neighbours stay neighbours (Shirley & Chiu 1997); density 1/pi.
struct DiskPoint {
  double x = 0.0, y = 0.0;
};
[[nodiscard]] DiskPoint sample_uniform_disk(double u, double v);

/// Barycentrics (b1, b2) of a point uniform in a triangle; density 1/area (Turk 1990).
struct TrianglePoint {
  double b1 = 0.0, b2 = 0.0;
};
[[nodiscard]] TrianglePoint sample_uniform_triangle(double u, double v);

}  // namespace raykiln::render
