#include "triangulate.hpp"

#include <cmath>

namespace raykiln::render::io {
namespace {

struct Point {
  double x = 0.0, y = 0.0;
};

// Twice the signed area of (a, b, c); positive when they turn left.
double turn(const Point& a, const Point& b, const Point& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

// Newell: sum of the cross products of consecutive corners, relative to the first one so that far
// away polygons do not lose their digits.
Vec3d newell_normal(std::span<const Vec3d> corners) {
  Vec3d sum(0.0);
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    sum += cross(corners[i] - corners[0], corners[i + 1] - corners[0]);
  }
  return sum;
}

// Drops the axis along which the normal is longest; keeps the winding counter-clockwise.
std::vector<Point> project(std::span<const Vec3d> corners, const Vec3d& normal) {
  const Vec3d size = glm::abs(normal);
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const int u = (axis + 1) % 3;
  const int v = (axis + 2) % 3;
  const double sign = normal[axis] < 0.0 ? -1.0 : 1.0;
  std::vector<Point> points;
  points.reserve(corners.size());
  for (const Vec3d& corner : corners) {
    const Vec3d p = corner - corners[0];
    points.push_back({p[u] * sign, p[v]});
  }
  return points;
}

// All turns to the left, and around the first corner in one sweep (otherwise a star passes too).
bool is_convex(const std::vector<Point>& p) {
  const std::size_t n = p.size();
  for (std::size_t i = 0; i < n; ++i) {
    if (turn(p[i], p[(i + 1) % n], p[(i + 2) % n]) < 0.0) return false;
  }
  for (std::size_t i = 1; i + 1 < n; ++i) {
    if (turn(p[0], p[i], p[i + 1]) < 0.0) return false;
  }
  return true;
}

class EarClipper {
 public:
  explicit EarClipper(const std::vector<Point>& points) : p_(points), n_(points.size()) {
    for (std::uint32_t i = 0; i < n_; ++i) {
      next_.push_back(static_cast<std::uint32_t>((i + 1) % n_));
      previous_.push_back(static_cast<std::uint32_t>((i + n_ - 1) % n_));
    }
    for (std::uint32_t i = 0; i < n_; ++i) ear_.push_back(is_ear(i));
  }

  // Each clipped ear re-examines its two neighbours only, so that n ears cost O(n^2) tests.
  PolygonStatus run(std::vector<std::array<std::uint32_t, 3>>& triangles) {
    std::uint32_t at = 0;
    std::size_t left = n_;
    std::size_t without_ear = 0;
    PolygonStatus status = PolygonStatus::kGood;
    while (left > 3) {
      if (!ear_[at] && without_ear < left) {
        at = next_[at];
        ++without_ear;
        continue;
      }
      if (!ear_[at]) status = PolygonStatus::kCrossing;
      clip(at, triangles);
      at = next_[at];
      --left;
      without_ear = 0;
    }
    triangles.push_back({previous_[at], at, next_[at]});
    // The areas of the pieces add up to that of the polygon: what was cut twice is missing here.
    if (turn(p_[previous_[at]], p_[at], p_[next_[at]]) < 0.0) status = PolygonStatus::kCrossing;
    return status;
  }

 private:
  [[nodiscard]] bool is_ear(std::uint32_t i) const {
    const Point& a = p_[previous_[i]];
    const Point& b = p_[i];
    const Point& c = p_[next_[i]];
    if (turn(a, b, c) <= 0.0) return false;
    for (std::uint32_t j = next_[next_[i]]; j != previous_[i]; j = next_[j]) {
      const Point& q = p_[j];
      const bool corner = same(q, a) || same(q, b) || same(q, c);
      if (!corner && turn(a, b, q) >= 0.0 && turn(b, c, q) >= 0.0 && turn(c, a, q) >= 0.0) {
        return false;
      }
    }
    return true;
  }
  static bool same(const Point& a, const Point& b) { return a.x == b.x && a.y == b.y; }

  void clip(std::uint32_t i, std::vector<std::array<std::uint32_t, 3>>& triangles) {
    const std::uint32_t before = previous_[i];
    const std::uint32_t after = next_[i];
    triangles.push_back({before, i, after});
    next_[before] = after;
    previous_[after] = before;
    ear_[before] = is_ear(before);
    ear_[after] = is_ear(after);
  }

  const std::vector<Point>& p_;
  std::size_t n_;
  std::vector<std::uint32_t> next_, previous_;
  std::vector<bool> ear_;
};

void fan(std::size_t n, std::vector<std::array<std::uint32_t, 3>>& triangles) {
  for (std::uint32_t i = 1; i + 1 < n; ++i) triangles.push_back({0, i, i + 1});
}

}  // namespace

PolygonStatus triangulate(std::span<const Vec3d> corners,
                          std::vector<std::array<std::uint32_t, 3>>& triangles) {
  if (corners.size() == 3) {
    triangles.push_back({0, 1, 2});
    return PolygonStatus::kGood;
  }
  const std::vector<Point> points = project(corners, newell_normal(corners));
  if (is_convex(points)) {
    fan(corners.size(), triangles);
    return PolygonStatus::kGood;
  }
  if (corners.size() > kMaxConcaveCorners) return PolygonStatus::kTooManyToClip;
  return EarClipper(points).run(triangles);
}

}  // namespace raykiln::render::io
