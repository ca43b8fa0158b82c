#include <array>
#include <cmath>

#include "raykiln/accel/kdtree_data.hpp"

namespace raykiln::render {
namespace {

// Adds b to a sum kept as an expansion of non-overlapping doubles (Shewchuk 1997, Grow-Expansion):
// the value stays exact. Products of two floats are exact doubles, so nothing is lost before.
template <std::size_t N>
void grow(std::array<double, N>& sum, std::size_t& size, double b) {
  for (std::size_t i = 0; i < size; ++i) {
    const double a = sum[i];
    const double total = a + b;
    const double b_part = total - a;
    sum[i] = (a - (total - b_part)) + (b - b_part);
    b = total;
  }
  sum[size++] = b;
}

// Twice the signed area of (a, b, c) in the plane of two axes is zero, exactly.
bool collinear_2d(double ax, double ay, double bx, double by, double cx, double cy) {
  const std::array<double, 6> terms{ax * by, -(ay * bx), bx * cy, -(by * cx), cx * ay, -(cy * ax)};
  double estimate = 0.0;
  double magnitude = 0.0;
  for (const double t : terms) {
    estimate += t;
    magnitude += std::abs(t);
  }
  if (std::abs(estimate) > magnitude * 0x1p-49) return false;  // five additions err by 5 * 2^-53
  std::array<double, 6> sum{};
  std::size_t size = 0;
  for (const double t : terms) grow(sum, size, t);
  for (const double part : sum) {
    if (part != 0.0) return false;  // the parts do not overlap: zero only if all are
  }
  return true;
}

}  // namespace

bool has_zero_area(const Vec3f& p0, const Vec3f& p1, const Vec3f& p2) {
  for (int i = 0; i < 3; ++i) {
    const int x = i;
    const int y = (i + 1) % 3;
    if (!collinear_2d(static_cast<double>(p0[x]), static_cast<double>(p0[y]),
                      static_cast<double>(p1[x]), static_cast<double>(p1[y]),
                      static_cast<double>(p2[x]), static_cast<double>(p2[y]))) {
      return false;
    }
  }
  return true;
}

}  // namespace raykiln::render
