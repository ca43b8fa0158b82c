#include "zero_area.hpp"

#include <array>
#include <cmath>
#include <cstddef>

namespace raykiln::render::io {
namespace {

// A sum of doubles kept as its parts: the value is the exact sum (Shewchuk 1997, "Adaptive
// precision floating-point arithmetic", grow-expansion). 16 parts hold two products of differences.
class ExactSum {
 public:
  void add(double x) {
    for (std::size_t i = 0; i < size_; ++i) {
      const double sum = x + part_[i];
      const double shifted = sum - x;
      part_[i] = (x - (sum - shifted)) + (part_[i] - shifted);
      x = sum;
    }
    part_[size_++] = x;
  }
  [[nodiscard]] bool is_zero() const {
    for (std::size_t i = 0; i < size_; ++i) {
      if (part_[i] != 0.0) return false;
    }
    return true;
  }

 private:
  std::array<double, 16> part_{};
  std::size_t size_ = 0;
};

struct Difference {
  double high, low;  // high + low = a - b exactly
};

Difference difference(double a, double b) {
  const double high = a - b;
  const double back = high - a;
  return {high, (a - (high - back)) - (b + back)};
}

void add_product(ExactSum& sum, double a, double b) {
  const double high = a * b;
  sum.add(high);
  sum.add(std::fma(a, b, -high));
}

void add_product(ExactSum& sum, const Difference& a, const Difference& b, double sign) {
  add_product(sum, a.high, sign * b.high);
  add_product(sum, a.high, sign * b.low);
  add_product(sum, a.low, sign * b.high);
  add_product(sum, a.low, sign * b.low);
}

// Is (b - a) x (c - a) = 0 in the plane of two axes?
bool collinear(double ax, double ay, double bx, double by, double cx, double cy) {
  const Difference ux = difference(bx, ax);
  const Difference uy = difference(by, ay);
  const Difference vx = difference(cx, ax);
  const Difference vy = difference(cy, ay);
  const double left = ux.high * vy.high;
  const double right = uy.high * vx.high;
  // The rounding errors of four operations are far below 1e-14 of the products.
  if (std::abs(left - right) > 1e-14 * (std::abs(left) + std::abs(right))) return false;
  ExactSum sum;
  add_product(sum, ux, vy, 1.0);
  add_product(sum, uy, vx, -1.0);
  return sum.is_zero();
}

}  // namespace

bool has_zero_area(const Vec3f& af, const Vec3f& bf, const Vec3f& cf) {
  const Vec3d a(af);
  const Vec3d b(bf);
  const Vec3d c(cf);
  return collinear(a.x, a.y, b.x, b.y, c.x, c.y) && collinear(a.y, a.z, b.y, b.z, c.y, c.z) &&
         collinear(a.z, a.x, b.z, b.x, c.z, c.x);
}

}  // namespace raykiln::render::io
