#include "polygon_clip.hpp"

#include <algorithm>
#include <utility>

#include "raykiln/math/float_bits.hpp"

namespace raykiln::render {
namespace {

using Point = std::array<double, 3>;

// A convex polygon; each of six planes adds at most one corner to the three.
struct Polygon {
  std::array<Point, 9> p;
  int n = 0;
};

// Where the edge a-b meets the plane, with the coordinate of the plane itself, not a rounded one.
Point cut(const Point& a, const Point& b, std::size_t axis, double plane) {
  const double s = (plane - a[axis]) / (b[axis] - a[axis]);
  Point c;
  for (std::size_t k = 0; k < 3; ++k) c[k] = a[k] + (b[k] - a[k]) * s;
  c[axis] = plane;
  return c;
}

// Sutherland & Hodgman 1974: keeps the side sign * (x - plane) <= 0, the plane included.
void clip(const Polygon& polygon, std::size_t axis, double plane, double sign, Polygon& kept) {
  kept.n = 0;
  double da = sign * (polygon.p[0][axis] - plane);
  for (int i = 0; i < polygon.n; ++i) {
    const Point& a = polygon.p[static_cast<std::size_t>(i)];
    const Point& b = polygon.p[static_cast<std::size_t>(i + 1 == polygon.n ? 0 : i + 1)];
    const double db = sign * (b[axis] - plane);
    if (da <= 0.0 && kept.n < 9) kept.p[static_cast<std::size_t>(kept.n++)] = a;
    if (((da < 0.0 && db > 0.0) || (da > 0.0 && db < 0.0)) && kept.n < 9) {
      kept.p[static_cast<std::size_t>(kept.n++)] = cut(a, b, axis, plane);
    }
    da = db;
  }
}

void extent(const Polygon& polygon, std::size_t axis, double& lo, double& hi) {
  lo = hi = polygon.p[0][axis];
  for (int i = 1; i < polygon.n; ++i) {
    lo = std::min(lo, polygon.p[static_cast<std::size_t>(i)][axis]);
    hi = std::max(hi, polygon.p[static_cast<std::size_t>(i)][axis]);
  }
}

}  // namespace

std::optional<Bounds3f> clipped_bounds(const std::array<Vec3f, 3>& corners, const Bounds3f& cell) {
  std::array<Polygon, 2> polygons;  // in turns what there is and what is kept of it
  Polygon* polygon = &polygons[0];
  Polygon* kept = &polygons[1];
  polygon->n = 3;
  for (std::size_t i = 0; i < 3; ++i) {
    polygon->p[i] = {static_cast<double>(corners[i].x), static_cast<double>(corners[i].y),
                     static_cast<double>(corners[i].z)};
  }
  double lo = 0.0;
  double hi = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto axis = static_cast<int>(k);
    const auto cell_lo = static_cast<double>(cell.lo[axis]);
    const auto cell_hi = static_cast<double>(cell.hi[axis]);
    extent(*polygon, k, lo, hi);
    if (lo < cell_lo) {
      clip(*polygon, k, cell_lo, -1.0, *kept);
      std::swap(polygon, kept);
      if (polygon->n == 0) return std::nullopt;
    }
    if (hi > cell_hi) {
      clip(*polygon, k, cell_hi, 1.0, *kept);
      std::swap(polygon, kept);
      if (polygon->n == 0) return std::nullopt;
    }
  }
  Bounds3f bounds;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto axis = static_cast<int>(k);
    extent(*polygon, k, lo, hi);
    bounds.lo[axis] = std::clamp(round_down(lo), cell.lo[axis], cell.hi[axis]);
    bounds.hi[axis] = std::clamp(round_up(hi), cell.lo[axis], cell.hi[axis]);
  }
  return bounds;
}

}  // namespace raykiln::render
