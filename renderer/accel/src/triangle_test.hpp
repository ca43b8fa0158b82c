// Does a ray meet a triangle: the watertight test of Woop, Benthin & Wald 2013 ("Watertight
// Ray/Triangle Intersection", JCGT 2(1)), the same for every walk, tree and leaf.
//
// A ray is sheared so that it runs along the z axis from the origin; a triangle is hit when the
// origin lies in its shadow on z = 0, the border included. Sheared corners are computed in float,
// each from the ray and the corner alone, so triangles that share a corner see the same numbers.
// Edge functions of floats are exact in double up to their last subtraction, which keeps the sign;
// hence two triangles never both miss at a common edge.
//
// Two steps: `passes_filter` is float arithmetic over a whole block. Rounding is monotone, so a
// float edge function never has the wrong sign, only zero (or NaN after overflow) in doubt; what is
// in doubt passes. `test_lane` then decides in double, so the answer is the same however the filter
// was compiled.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "raykiln/accel/kdtree.hpp"
#include "raykiln/accel/kdtree_data.hpp"

namespace raykiln::render {

/// Directions whose largest component is outside of these count as zero or infinite: no hit.
inline constexpr float kMinDirection = 0x1p-100F;
inline constexpr float kMaxDirection = 0x1p100F;

/// A ray made ready for the test.
struct ShearedRay {
  std::array<float, 3> o{};
  std::array<std::size_t, 3> k{0, 1, 2};  ///< axes x, y, z of the sheared space
  float sx = 0.0F, sy = 0.0F;
  double inv_dz = 0.0;
  float t_min = 0.0F, t_max = 0.0F;
};

/// False when the ray can hit nothing: a number that is not finite, no direction, an empty interval.
[[nodiscard]] inline bool prepare(const Ray& ray, ShearedRay& out) {
  const float ax = std::abs(ray.d.x);
  const float ay = std::abs(ray.d.y);
  const float az = std::abs(ray.d.z);
  const std::size_t kz = ax >= ay && ax >= az ? 0U : (ay >= az ? 1U : 2U);
  const std::array<float, 3> d{ray.d.x, ray.d.y, ray.d.z};
  const float longest = std::abs(d[kz]);
  // Written so that NaN fails.
  const bool finite = ax <= kMaxDirection && ay <= kMaxDirection && az <= kMaxDirection &&
                      std::isfinite(ray.o.x) && std::isfinite(ray.o.y) && std::isfinite(ray.o.z);
  if (!finite || !(longest >= kMinDirection) || !(ray.t_min <= ray.t_max)) return false;
  out.o = {ray.o.x, ray.o.y, ray.o.z};
  out.k = {(kz + 1) % 3, (kz + 2) % 3, kz};
  out.sx = d[out.k[0]] / d[kz];
  out.sy = d[out.k[1]] / d[kz];
  out.inv_dz = 1.0 / static_cast<double>(d[kz]);
  out.t_min = ray.t_min;
  out.t_max = ray.t_max;
  return true;
}

/// Sheared corners of one triangle: x, y in the plane across the ray, z along its main axis.
struct ShearedTriangle {
  std::array<float, 3> x, y, z;
};

template <int W>
[[nodiscard]] inline ShearedTriangle shear(const ShearedRay& ray, const LeafBlock<W>& block,
                                           std::size_t lane) {
  ShearedTriangle s;
  for (std::size_t c = 0; c < 3; ++c) {
    s.z[c] = block.v[c][ray.k[2]][lane] - ray.o[ray.k[2]];
    s.x[c] = (block.v[c][ray.k[0]][lane] - ray.o[ray.k[0]]) - ray.sx * s.z[c];
    s.y[c] = (block.v[c][ray.k[1]][lane] - ray.o[ray.k[1]]) - ray.sy * s.z[c];
  }
  return s;
}

/// pass[lane] = 0 where the triangle is missed for certain. Vectorises over the lanes.
template <int W>
inline void passes_filter(const ShearedRay& ray, const LeafBlock<W>& block,
                          std::array<std::int32_t, W>& pass) {
  for (std::size_t lane = 0; lane < W; ++lane) {
    const ShearedTriangle s = shear(ray, block, lane);
    const float u = s.x[2] * s.y[1] - s.y[2] * s.x[1];
    const float v = s.x[0] * s.y[2] - s.y[0] * s.x[2];
    const float w = s.x[1] * s.y[0] - s.y[1] * s.x[0];
    const int negative = static_cast<int>(u < 0.0F) | static_cast<int>(v < 0.0F) |
                         static_cast<int>(w < 0.0F);
    const int positive = static_cast<int>(u > 0.0F) | static_cast<int>(v > 0.0F) |
                         static_cast<int>(w > 0.0F);
    pass[lane] = 1 - (negative & positive);
  }
}

/// The hit of one triangle within [t_min, t_max] of the ray. False on a miss.
template <int W>
[[nodiscard]] inline bool test_lane(const ShearedRay& ray, const LeafBlock<W>& block,
                                    std::size_t lane, Hit& hit) {
  const ShearedTriangle s = shear(ray, block, lane);
  const auto cross = [&](std::size_t a, std::size_t b) {  // exact products, one rounding
    return static_cast<double>(s.x[a]) * static_cast<double>(s.y[b]) -
           static_cast<double>(s.y[a]) * static_cast<double>(s.x[b]);
  };
  const double u = cross(2, 1);
  const double v = cross(0, 2);
  const double w = cross(1, 0);
  if ((u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0)) return false;
  const double det = u + v + w;
  if (!(det > 0.0 || det < 0.0)) return false;  // seen edge-on, or NaN
  const double depth = (u * static_cast<double>(s.z[0]) + v * static_cast<double>(s.z[1]) +
                        w * static_cast<double>(s.z[2])) * ray.inv_dz;
  const auto t = static_cast<float>(depth / det);
  if (!(t >= ray.t_min && t <= ray.t_max && t <= std::numeric_limits<float>::max() &&
        t >= std::numeric_limits<float>::lowest())) {
    return false;
  }
  hit = {t, block.id[lane], static_cast<float>(v / det), static_cast<float>(w / det)};
  return true;
}

/// Calls accept(hit) for every triangle of the block that the ray meets, in lane order, until it
/// returns true; says whether it did.
template <int W, typename Accept>
inline bool test_block(const ShearedRay& ray, const LeafBlock<W>& block, Accept&& accept) {
  std::array<std::int32_t, W> pass;
  passes_filter<W>(ray, block, pass);
  for (std::size_t lane = 0; lane < W; ++lane) {
    Hit hit;
    if (pass[lane] == 0 || block.id[lane] == kNoHit || !test_lane(ray, block, lane, hit)) continue;
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

}  // namespace raykiln::render
