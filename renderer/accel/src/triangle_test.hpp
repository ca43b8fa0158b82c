// Does a ray meet a triangle: the watertight test of Woop, Benthin & Wald 2013 ("Watertight
// Ray/Triangle Intersection", JCGT 2(1)), the same for every walk, tree and leaf.
//
// A ray is sheared so that it runs along the z axis from the origin; a triangle is hit when the
// origin lies in its shadow on z = 0, the border included. A sheared corner depends on the ray and
// that corner alone and the sign of an edge function is exact, so triangles that share an edge or
// a corner never both miss there.
//
// `test_lane` decides, in double. In float the corners would move by up to 6 u |corner - origin|
// (u = 2^-24): a triangle of a kilometre would be uncertain by half a millimetre everywhere, and a
// walk that must agree with brute force would have to enlarge every cell by that much.
// `passes_filter` is float arithmetic over a whole block and rejects only what test_lane rejects for
// certain; so results do not depend on how it was compiled.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "raykiln/accel/kdtree.hpp"
#include "raykiln/accel/kdtree_data.hpp"
#include "walk_limits.hpp"

namespace raykiln::render {

/// A ray made ready for the test.
struct ShearedRay {
  std::array<float, 3> o{};
  std::array<std::size_t, 3> k{0, 1, 2};  ///< axes x, y, z of the sheared space
  double sx = 0.0, sy = 0.0, inv_dz = 0.0;
  float t_min = 0.0F, t_max = 0.0F;
};

/// The axis along which a ray moves most.
[[nodiscard]] inline std::size_t main_axis(const Ray& ray) {
  const float ax = std::abs(ray.d.x);
  const float ay = std::abs(ray.d.y);
  const float az = std::abs(ray.d.z);
  return ax >= ay && ax >= az ? 0U : (ay >= az ? 1U : 2U);
}

/// Makes a ray ready that is known to be usable.
inline void shear_ray(const Ray& ray, ShearedRay& out) {
  const std::size_t kz = main_axis(ray);
  const std::array<float, 3> d{ray.d.x, ray.d.y, ray.d.z};
  const auto dz = static_cast<double>(d[kz]);
  out.o = {ray.o.x, ray.o.y, ray.o.z};
  out.k = {(kz + 1) % 3, (kz + 2) % 3, kz};
  out.sx = static_cast<double>(d[out.k[0]]) / dz;
  out.sy = static_cast<double>(d[out.k[1]]) / dz;
  out.inv_dz = 1.0 / dz;
  out.t_min = ray.t_min;
  out.t_max = ray.t_max;
}

/// False when the ray can hit nothing: a number that is not finite, no direction, an empty interval.
[[nodiscard]] inline bool is_usable(const Ray& ray) {
  const float longest = std::abs(ray.d[static_cast<int>(main_axis(ray))]);
  // Written so that NaN fails.
  const bool finite = std::abs(ray.d.x) <= kMaxDirection && std::abs(ray.d.y) <= kMaxDirection &&
                      std::abs(ray.d.z) <= kMaxDirection && std::isfinite(ray.o.x) &&
                      std::isfinite(ray.o.y) && std::isfinite(ray.o.z);
  return finite && longest >= kMinDirection && ray.t_min <= ray.t_max;
}

/// Makes a ray ready; false when it is not usable.
[[nodiscard]] inline bool prepare(const Ray& ray, ShearedRay& out) {
  if (!is_usable(ray)) return false;
  shear_ray(ray, out);
  return true;
}

/// Sheared corners of one triangle: x, y in the plane across the ray, z along its main axis.
template <typename Real>
struct ShearedTriangle {
  std::array<Real, 3> x, y, z;
};

template <typename Real, typename AnyRay, int W>
[[nodiscard]] inline ShearedTriangle<Real> shear(const AnyRay& ray, const LeafBlock<W>& block,
                                                 std::size_t lane) {
  const std::array<Real, 3> o{static_cast<Real>(ray.o[ray.k[0]]), static_cast<Real>(ray.o[ray.k[1]]),
                              static_cast<Real>(ray.o[ray.k[2]])};
  const auto sx = static_cast<Real>(ray.sx);
  const auto sy = static_cast<Real>(ray.sy);
  ShearedTriangle<Real> s;
  for (std::size_t c = 0; c < 3; ++c) {
    s.z[c] = static_cast<Real>(block.v[c][ray.k[2]][lane]) - o[2];
    s.x[c] = (static_cast<Real>(block.v[c][ray.k[0]][lane]) - o[0]) - sx * s.z[c];
    s.y[c] = (static_cast<Real>(block.v[c][ray.k[1]][lane]) - o[1]) - sy * s.z[c];
  }
  return s;
}

inline float largest_magnitude(const std::array<float, 3>& a) {
  const float b = std::abs(a[0]) > std::abs(a[1]) ? std::abs(a[0]) : std::abs(a[1]);
  return b > std::abs(a[2]) ? b : std::abs(a[2]);
}

/// pass[lane] = 0 where the triangle is missed for certain. Vectorises over the lanes.
///
/// With h the largest |x|, |y| and m = h + max |z| >= max |corner - origin|, a sheared coordinate is
/// off by at most 6 u m: one rounding each of the two differences, the slope and the product, and
/// one of a result up to 2 m. An edge function is then off by at most 24 u m h + 72 u^2 m^2 + 8 u m h
/// (the corners' errors, their products, its own three roundings), which is below 40 u m (h + 4 u m).
template <int W>
inline void passes_filter(const ShearedRay& ray, const LeafBlock<W>& block,
                          std::array<std::int32_t, W>& pass) {
  for (std::size_t lane = 0; lane < W; ++lane) {
    const auto s = shear<float>(ray, block, lane);
    const float u = s.x[2] * s.y[1] - s.y[2] * s.x[1];
    const float v = s.x[0] * s.y[2] - s.y[0] * s.x[2];
    const float w = s.x[1] * s.y[0] - s.y[1] * s.x[0];
    const float hx = largest_magnitude(s.x);
    const float hy = largest_magnitude(s.y);
    const float h = hx > hy ? hx : hy;
    const float m = h + largest_magnitude(s.z);
    // m (h + ...) first: where a product of corners overflows, so does this, and the lane passes.
    const float e = (m * (h + kFilterCorner * m)) * kFilterEdge + kFilterUnderflow;
    const int negative = static_cast<int>(u < -e) | static_cast<int>(v < -e) |
                         static_cast<int>(w < -e);
    const int positive = static_cast<int>(u > e) | static_cast<int>(v > e) |
                         static_cast<int>(w > e);
    pass[lane] = 1 - (negative & positive);  // NaN after overflow passes
  }
}

/// a b - c d with an exact sign: products are rounded monotonously, so only 0 is in doubt, and then
/// the parts that rounding cut off decide.
[[nodiscard]] inline double difference_of_products(double a, double b, double c, double d) {
  const double ab = a * b;
  const double cd = c * d;
  if (ab != cd) return ab - cd;
  return std::fma(a, b, -ab) - std::fma(c, d, -cd);
}

/// The hit of one triangle within [t_min, t_max] of the ray. False on a miss.
template <int W>
[[nodiscard]] inline bool test_lane(const ShearedRay& ray, const LeafBlock<W>& block,
                                    std::size_t lane, Hit& hit) {
  const auto s = shear<double>(ray, block, lane);
  const auto cross = [&](std::size_t a, std::size_t b) {
    return difference_of_products(s.x[a], s.y[b], s.y[a], s.x[b]);
  };
  const double u = cross(2, 1);
  const double v = cross(0, 2);
  const double w = cross(1, 0);
  if ((u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0)) return false;
  const double det = u + v + w;
  if (!(det > 0.0 || det < 0.0)) return false;  // seen edge-on, or NaN
  const double depth = (u * s.z[0] + v * s.z[1] + w * s.z[2]) * ray.inv_dz;
  const auto t = static_cast<float>(depth / det);
  if (!(t >= ray.t_min && t <= ray.t_max && t <= std::numeric_limits<float>::max() &&
        t >= std::numeric_limits<float>::lowest())) {
    return false;
  }
  hit = {t, block.id[lane], static_cast<float>(v / det), static_cast<float>(w / det)};
  return true;
}

/// Calls accept(hit) for every triangle of the block that the ray meets, in lane order, until it
/// returns true; says whether it did. Adds to `decided` what the filter let pass.
template <int W, typename Accept>
inline bool test_block(const ShearedRay& ray, const LeafBlock<W>& block, std::uint64_t& decided,
                       Accept&& accept) {
  std::array<std::int32_t, W> pass;
  passes_filter<W>(ray, block, pass);
  for (std::size_t lane = 0; lane < W; ++lane) {
    if (pass[lane] == 0 || block.id[lane] == kNoHit) continue;
    ++decided;
    Hit hit;
    if (!test_lane(ray, block, lane, hit)) continue;
    if (accept(hit)) return true;
  }
  return false;
}

/// Lexicographic order of (t, id).
[[nodiscard]] inline bool comes_before(const Hit& a, const Hit& b) {
  return a.t < b.t || (a.t == b.t && a.id < b.id);
}
[[nodiscard]] inline bool comes_after(const Hit& a, const HitOrder& b) {
  return a.t > b.t || (a.t == b.t && a.id > b.id);
}

/// The watertight test as what a search is made of; FastTest of fast_test.hpp is the other one.
struct WatertightTest {
  using Prepared = ShearedRay;
  static constexpr bool kMoreSlack = false;

  [[nodiscard]] static bool prepare(const Ray& ray, const Bounds3f& /*box*/, Prepared& out) {
    return render::prepare(ray, out);
  }
  template <int W, typename Accept>
  static bool block(const Prepared& ray, const LeafBlock<W>& block, std::uint64_t& decided,
                    Accept&& accept) {
    return test_block(ray, block, decided, accept);
  }
  template <int W>
  [[nodiscard]] static bool lane(const Prepared& ray, const LeafBlock<W>& block, std::size_t lane,
                                 Hit& hit) {
    return test_lane(ray, block, lane, hit);
  }
};

}  // namespace raykiln::render
