// Directions of a diffuse surface, drawn in part towards bodies that may focus light of emitters there: no shadow ray
// passes through those, so paths have to find it. The density is that of the mixture, which leaves expectations as
// they are (balance heuristic with one sample, Veach & Guibas 1995; directions towards bodies: Jensen 1996).
// A lane kernel of renderer/integrator does the same operations in the same order.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>

#include "raykiln/sampling/warp.hpp"
#include "raykiln/shading/bsdf.hpp"
#include "raykiln/shading/caustic_casters.hpp"
#include "raykiln/shading/matte_bsdf.hpp"

namespace raykiln::render {

inline constexpr double kCasterBoost = 2.0;    ///< directions to a small body, besides the cosine's own, over those
inline constexpr double kMostToCasters = 0.2;  ///< of all directions
/// Surfaces of a path beyond this number of reflections keep to their own directions: each mixture may raise a weight
/// by 1/(1 - kMostToCasters), and roulette must not undo that, so there have to be few.
inline constexpr std::uint32_t kLastCasterBounce = 2;
/// Squared sine of the least half angle: below, rounding a direction to float moves too many across the edge.
inline constexpr double kLeastCone = 1e-4;

/// The cones of bodies as one surface point sees them.
struct CasterCones {
  struct Cone {
    Vec3f axis{0.0F};
    double width = 0.0;    ///< 1 - cos of the half angle
    double share = 0.0;    ///< probability of drawing from it
    double density = 0.0;  ///< share over solid angle, sr^-1
  };
  std::array<Cone, kMostCasters> cones{};
  std::size_t count = 0;
  double part = 0.0;  ///< diffuse share of the surface's own directions
  double rest = 1.0;  ///< probability of drawing one of those
};

/// From `p` on a surface of unit normal `n`, turned to the viewer; `part` of its directions are diffuse. A cone's share of cosine-weighted directions is about sin^2 cos; one that is large gains nothing from being drawn from.
inline void see_casters(CasterCones& seen, std::span<const CausticCaster> casters, const Vec3d& p, const Vec3d& n,
                        double part) {
  seen.count = casters.size();
  seen.part = part;
  seen.rest = 1.0;
  double sum = 0.0;
  for (std::size_t i = 0; i < casters.size(); ++i) {
    CasterCones::Cone& cone = seen.cones[i];
    cone = {};
    const Vec3d way = casters[i].centre - p;
    const double distance2 = dot(way, way);
    const double sine2 = casters[i].radius * casters[i].radius / distance2;
    if (!(sine2 >= kLeastCone && sine2 < 1.0)) continue;
    cone.axis = Vec3f(way / std::sqrt(distance2));
    const double height = dot(n, Vec3d(cone.axis));
    if (!(height > 0.0)) continue;
    cone.width = sine2 / (1.0 + std::sqrt(1.0 - sine2));
    const double fraction = sine2 * height;
    cone.share = kCasterBoost * fraction * ((1.0 - fraction) * (1.0 - fraction));
    sum += cone.share;
  }
  const double scale = (sum > kMostToCasters ? kMostToCasters / sum : 1.0) * part;
  for (std::size_t i = 0; i < seen.count; ++i) {
    CasterCones::Cone& cone = seen.cones[i];
    if (!(cone.share > 0.0)) continue;
    cone.share *= scale;
    cone.density = cone.share / (2.0 * kPi * cone.width);
    seen.rest -= cone.share;
  }
}

/// Density of wi, unit, in the mixture with the surface's own `pdf`, sr^-1.
inline double mixed_pdf(const CasterCones& seen, const Vec3f& wi, double pdf) {
  double mixed = seen.rest * pdf;
  for (std::size_t i = 0; i < seen.count; ++i) {
    const CasterCones::Cone& cone = seen.cones[i];
    const Vec3d apart = Vec3d(wi) - Vec3d(cone.axis);
    if (0.5 * dot(apart, apart) <= cone.width) mixed += cone.density;
  }
  return mixed;
}

/// The probability with which sample_bsdf() gives a diffuse direction; exactly 1 where there is no other.
template <bool kNormals>
double diffuse_part(const MatteBsdf<kNormals>&) {
  return 1.0;
}
inline double diffuse_part(const Bsdf& b) { return 1.0 - b.choice.specular; }

/// sample_bsdf() of the mixture. With dimensions kLobeChoice, kFresnelChoice, kDirectionU and kDirectionV: what is left of the
/// first where no cone is drawn chooses the lobe. What of a weight is due to the mixture is no loss of light, so that
/// roulette does not undo it: it stands in radiance_scale.
template <class Lobes>
BsdfSample sample_mixture(const Lobes& bsdf, const CasterCones& seen, const VertexKey& vertex) {
  DirectionNumbers numbers = direction_numbers(vertex);
  std::size_t drawn = seen.count;
  for (std::size_t i = 0; i < seen.count && drawn == seen.count; ++i) {
    if (numbers.lobe < seen.cones[i].share) {
      drawn = i;
    } else {
      numbers.lobe -= seen.cones[i].share;
    }
  }
  BsdfSample sample{.lobe = Lobe::kDiffuse};
  if (drawn < seen.count) {
    const CasterCones::Cone& cone = seen.cones[drawn];
    sample.wi = around_axis(cone.axis, cone.width * numbers.u, numbers.v);
  } else {
    numbers.lobe = std::min(numbers.lobe / seen.rest, 0x1.fffffffffffffp-1);
    sample = sample_bsdf(bsdf, numbers);
    if (sample.lobe == Lobe::kNone) return sample;
  }
  // A narrow lobe's density is known better from its sample than from its direction.
  const bool exact = drawn < seen.count || seen.part == 1.0;
  const BsdfValue value = exact ? evaluate(bsdf, sample.wi) : BsdfValue{sample.weight, sample.pdf};
  if (value.f_cos == Rgbd(0.0)) return {};
  const double pdf = mixed_pdf(seen, sample.wi, value.pdf), ratio = value.pdf / pdf;
  sample.weight = exact ? value.f_cos / pdf : sample.weight * ratio;
  sample.radiance_scale *= ratio;
  sample.pdf = pdf;
  return sample;
}

}  // namespace raykiln::render
