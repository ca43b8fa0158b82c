// The GGX distribution of microfacets (Walter et al. 2007) with height-correlated masking and
// shadowing (Heitz 2014). Directions are in the frame of the surface: z is its normal, cosines are z.
#pragma once

#include <algorithm>
#include <cmath>

#include "raykiln/math/vec.hpp"

namespace raykiln::render {

/// Below it lobes are narrower than a float direction can tell, and the square is still far from 0.
inline constexpr double kLeastAlpha = 1e-8;

/// Width of the distribution for glTF's roughness: its square.
[[nodiscard]] inline double ggx_alpha(double roughness) {
  return std::max(roughness * roughness, kLeastAlpha);
}

/// sqrt(cos^2 + alpha^2 sin^2), so that G1 = 2 cos / (cos + this): finite at grazing.
[[nodiscard]] inline double ggx_span(double cosine, double alpha) {
  return std::sqrt(cosine * cosine + alpha * alpha * std::max((1.0 - cosine) * (1.0 + cosine), 0.0));
}

/// Density of facets by projected area at a tilt of these squared sine and cosine. Without 1 - alpha^2,
/// which would cancel.
[[nodiscard]] inline double ggx_density(double sin2, double cos2, double alpha) {
  const double stretched = sin2 / (alpha * alpha) + cos2;
  return 1.0 / (3.14159265358979323846 * alpha * alpha * stretched * stretched);
}

/// A facet's normal, drawn with density D(h) G1(wo) max(wo.h, 0) / wo.z: spherical caps (Dupuy &
/// Benyoub 2023). wo.z >= 0. The height 1 + z of the cap is taken as it is drawn: no cancellation.
[[nodiscard]] inline Vec3d ggx_visible_normal(const Vec3d& wo, double alpha, double u, double v) {
  const Vec3d w = normalize(Vec3d(alpha * wo.x, alpha * wo.y, wo.z));
  const double phi = 2.0 * 3.14159265358979323846 * u;
  const double height = (1.0 - v) * (1.0 + w.z);
  const double z = height - w.z;
  const double s = std::sqrt(std::max((1.0 - z) * (1.0 + z), 0.0));
  return normalize(Vec3d(alpha * (s * std::cos(phi) + w.x), alpha * (s * std::sin(phi) + w.y), height));
}

/// G2/G1(wo): what is neither masked nor shadowed of light that a visible facet sends to cosine `to`.
/// In [0, 1]; the spans belong to the cosines.
[[nodiscard]] inline double ggx_passes(double from, double from_span, double to, double to_span) {
  const double whole = from_span * to + to_span * from;
  return whole > 0.0 ? to * (from + from_span) / whole : 0.0;
}

/// 1 - ggx_passes, without cancellation.
[[nodiscard]] inline double ggx_stopped(double from, double from_span, double to, double to_span,
                                        double alpha) {
  const double whole = from_span * to + to_span * from;
  const double more = alpha * alpha * (1.0 - to * to) / (to_span + to);  // to_span - to
  return whole > 0.0 ? from * more / whole : 1.0;
}

}  // namespace raykiln::render
