// The fast triangle test: the float part of Woop, Benthin & Wald 2013 without a bound on its errors,
// with the same operations in the same order in every walk, so that their hits are the same bits.
//
// Let u = 2^-24 and E the largest coordinate of the root's box as seen from the ray's origin. Corners
// are sheared in float, which moves them by up to 6 u E; they still depend on ray and corner alone, and
// products are rounded monotonously, so the sign of an edge function is right or zero, and zero counts
// as inside. A triangle that has no area left in float is missed: that is where a closed mesh leaks.
//
// A hit's t is the depth of the point a p0 + b p1 + c p2 of the triangle, with the weights of the
// edge functions. Where these are mostly rounding, as on triangles seen nearly edge-on, that point may
// lie far from the ray, and a walk would look for the hit in other cells than brute force. So weights
// that leave the ray by more than 32 u E are formed anew in double, in which edge functions of float
// corners have 2^-53 of error only. Then the point of any hit is off the ray by 32 u E, 6 u E for the
// corners, 6 for the roundings of that sum, 8 for those of the weights, and 10 for depth and t: less
// than kFastSlack E = 64 u E, by which walks take cells to be larger for this test.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "triangle_test.hpp"

namespace raykiln::render {

struct FastRay {
  std::array<float, 3> o{};
  std::array<std::size_t, 3> k{0, 1, 2};  ///< axes x, y, z of the sheared space
  float sx = 0.0F, sy = 0.0F, inv_dz = 0.0F;
  float t_min = 0.0F, t_max = 0.0F;
  float tolerance = 0.0F;  ///< how far weights may leave the ray
};

template <typename Real>
[[nodiscard]] inline bool have_mixed_signs(Real u, Real v, Real w) {
  // Without branches, for the loop vectoriser.
  const int negative = static_cast<int>(u < 0) | static_cast<int>(v < 0) | static_cast<int>(w < 0);
  const int positive = static_cast<int>(u > 0) | static_cast<int>(v > 0) | static_cast<int>(w > 0);
  return (negative & positive) != 0;
}

/// Twice the areas that the origin makes with the edges of a sheared triangle.
template <typename Real>
struct EdgeFunctions {
  Real u, v, w;

  explicit EdgeFunctions(const ShearedTriangle<Real>& s)
      : u(s.x[2] * s.y[1] - s.y[2] * s.x[1]),
        v(s.x[0] * s.y[2] - s.y[0] * s.x[2]),
        w(s.x[1] * s.y[0] - s.y[1] * s.x[0]) {}
  [[nodiscard]] Real sum() const { return u + v + w; }
};

[[nodiscard]] inline bool keep_if_within(const FastRay& ray, float t, float b, float c,
                                         std::uint32_t id, Hit& hit) {
  if (!(t >= ray.t_min && t <= ray.t_max && std::abs(t) <= std::numeric_limits<float>::max())) {
    return false;
  }
  hit = {t, id, b, c};
  return true;
}

/// The same corners with weights in double.
[[nodiscard]] inline bool hit_in_doubt(const FastRay& ray, const ShearedTriangle<float>& s,
                                       std::uint32_t id, Hit& hit) {
  ShearedTriangle<double> d;
  for (std::size_t c = 0; c < 3; ++c) {
    d.x[c] = static_cast<double>(s.x[c]);
    d.y[c] = static_cast<double>(s.y[c]);
    d.z[c] = static_cast<double>(s.z[c]);
  }
  const EdgeFunctions<double> e(d);
  if (have_mixed_signs(e.u, e.v, e.w)) return false;
  const double det = e.sum();
  if (!(det > 0.0 || det < 0.0)) return false;
  const double depth = (e.u * d.z[0] + e.v * d.z[1] + e.w * d.z[2]) / det;
  return keep_if_within(ray, static_cast<float>(depth * static_cast<double>(ray.inv_dz)),
                        static_cast<float>(e.v / det), static_cast<float>(e.w / det), id, hit);
}

struct FastTest {
  using Prepared = FastRay;
  static constexpr bool kMoreSlack = true;

  [[nodiscard]] static float more_slack(const Bounds3f& box, const Vec3f& o) {
    float reach = 0.0F;
    for (int k = 0; k < 3; ++k) {
      reach = std::max({reach, std::abs(box.lo[k] - o[k]), std::abs(box.hi[k] - o[k])});
    }
    return kFastSlack * reach;
  }

  [[nodiscard]] static bool prepare(const Ray& ray, const Bounds3f& box, FastRay& out) {
    if (!is_usable(ray)) return false;
    const std::size_t kz = main_axis(ray);
    const std::array<float, 3> d{ray.d.x, ray.d.y, ray.d.z};
    out.o = {ray.o.x, ray.o.y, ray.o.z};
    out.k = {(kz + 1) % 3, (kz + 2) % 3, kz};
    out.sx = d[out.k[0]] / d[kz];
    out.sy = d[out.k[1]] / d[kz];
    out.inv_dz = 1.0F / d[kz];
    out.t_min = ray.t_min;
    out.t_max = ray.t_max;
    out.tolerance = kFastTolerance * more_slack(box, ray.o);
    return true;
  }

  template <int W>
  [[nodiscard]] static bool lane(const FastRay& ray, const LeafBlock<W>& block, std::size_t lane,
                                 Hit& hit) {
    const auto s = shear<float>(ray, block, lane);
    const EdgeFunctions<float> e(s);
    const float det = e.sum();
    if (have_mixed_signs(e.u, e.v, e.w) || !(det > 0.0F || det < 0.0F)) return false;
    const float inv = 1.0F / det;
    const float a = e.u * inv;
    const float b = e.v * inv;
    const float c = e.w * inv;
    const auto mean = [&](const std::array<float, 3>& of) { return a * of[0] + b * of[1] + c * of[2]; };
    if (!(std::abs(det) <= kFastLargestDeterminant && std::abs(mean(s.x)) <= ray.tolerance &&
          std::abs(mean(s.y)) <= ray.tolerance)) {
      return hit_in_doubt(ray, s, block.id[lane], hit);
    }
    return keep_if_within(ray, mean(s.z) * ray.inv_dz, b, c, block.id[lane], hit);
  }

  /// As test_block; nothing is decided in double but weights in doubt, which are not counted.
  template <int W, typename Accept>
  static bool block(const FastRay& ray, const LeafBlock<W>& block, std::uint64_t& /*decided*/,
                    Accept&& accept) {
    std::array<std::int32_t, W> met;
    for (std::size_t i = 0; i < W; ++i) {
      const EdgeFunctions<float> e(shear<float>(ray, block, i));
      const float det = e.sum();
      const int area = static_cast<int>(det > 0.0F) | static_cast<int>(det < 0.0F);
      met[i] = area & (1 - static_cast<int>(have_mixed_signs(e.u, e.v, e.w)));
    }
    for (std::size_t i = 0; i < W; ++i) {
      Hit hit;
      if (met[i] == 0 || block.id[i] == kNoHit || !lane(ray, block, i, hit)) continue;
      if (accept(hit)) return true;
    }
    return false;
  }
};

}  // namespace raykiln::render
