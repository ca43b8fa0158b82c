// The part of a triangle inside of a box in rational arithmetic: the truth that clipping is
// compared with.
#pragma once

#include <algorithm>
#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <optional>
#include <vector>

#include "raykiln/math/ray.hpp"

namespace raykiln::hard {

using Rational = boost::multiprecision::cpp_rational;
using ExactPoint = std::array<Rational, 3>;
using ExactPolygon = std::vector<ExactPoint>;

inline ExactPolygon exact_triangle(const std::array<render::Vec3f, 3>& corners) {
  ExactPolygon polygon;
  for (const auto& p : corners) polygon.push_back({Rational(p.x), Rational(p.y), Rational(p.z)});
  return polygon;
}

/// Keeps sign * (x - plane) <= 0.
inline ExactPolygon exact_half(const ExactPolygon& polygon, std::size_t axis, const Rational& plane,
                               int sign) {
  ExactPolygon kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const ExactPoint& a = polygon[i];
    const ExactPoint& b = polygon[(i + 1) % polygon.size()];
    const Rational da = sign * (a[axis] - plane);
    const Rational db = sign * (b[axis] - plane);
    if (da <= 0) kept.push_back(a);
    if ((da < 0 && db > 0) || (da > 0 && db < 0)) {
      const Rational s = da / (da - db);
      ExactPoint c;
      for (std::size_t k = 0; k < 3; ++k) c[k] = a[k] + s * (b[k] - a[k]);
      kept.push_back(c);
    }
  }
  return kept;
}

/// The closed box.
inline ExactPolygon exact_clip(const std::array<render::Vec3f, 3>& corners,
                               const render::Bounds3f& box) {
  ExactPolygon polygon = exact_triangle(corners);
  for (std::size_t k = 0; k < 3 && !polygon.empty(); ++k) {
    polygon = exact_half(polygon, k, Rational(box.lo[static_cast<int>(k)]), -1);
    polygon = exact_half(polygon, k, Rational(box.hi[static_cast<int>(k)]), 1);
  }
  return polygon;
}

/// True when three of the corners are not on one line.
inline bool has_area(const ExactPolygon& polygon) {
  if (polygon.size() < 3) return false;
  const ExactPoint& o = polygon[0];
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t a = (k + 1) % 3;
      const std::size_t b = (k + 2) % 3;
      const Rational cross = (polygon[i][a] - o[a]) * (polygon[i + 1][b] - o[b]) -
                             (polygon[i][b] - o[b]) * (polygon[i + 1][a] - o[a]);
      if (cross != 0) return true;
    }
  }
  return false;
}

/// How far the polygon sticks out of the closed box, along an axis; 0 when it lies inside.
inline double excess(const render::Bounds3f& box, const ExactPolygon& polygon) {
  Rational most = 0;
  for (const ExactPoint& p : polygon) {
    for (int k = 0; k < 3; ++k) {
      const Rational& x = p[static_cast<std::size_t>(k)];
      most = std::max({most, Rational(Rational(box.lo[k]) - x), Rational(x - Rational(box.hi[k]))});
    }
  }
  return most.convert_to<double>();
}

}  // namespace raykiln::hard
