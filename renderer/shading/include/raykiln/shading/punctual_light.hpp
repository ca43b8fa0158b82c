// What distance and direction leave of the light of a point or a spot.
#pragma once

#include <algorithm>

#include "raykiln/scene/light.hpp"

namespace raykiln::render {

/// Share of inverse-square light that a range leaves: 1 - (d/range)^4, 0 beyond it, as
/// KHR_lights_punctual recommends. 1 for kEndlessRange, exactly.
[[nodiscard]] inline double range_share(double distance2, float range) {
  const double r = static_cast<double>(range);
  const double ratio2 = distance2 / (r * r);
  return std::max(1.0 - ratio2 * ratio2, 0.0);
}

/// Share of a spot's intensity that goes along `way` (unit, away from the light): between the cones
/// the square of what is linear in the cosine, as in the reference code of KHR_lights_punctual.
/// That code's least difference of 0.001 between the cosines is left out: it would darken cones
/// narrower than 2.6 degrees all over.
[[nodiscard]] inline double cone_share(const SpotLight& light, const Vec3d& way) {
  const Vec3d chord = way - light.axis;
  const double x = 0.5 * dot(chord, chord);  // 1 - cos, without cancellation
  if (x <= light.inner_one_minus_cos) return 1.0;
  if (!(x < light.outer_one_minus_cos)) return 0.0;
  const double t =
      (light.outer_one_minus_cos - x) / (light.outer_one_minus_cos - light.inner_one_minus_cos);
  return t * t;
}

}  // namespace raykiln::render
