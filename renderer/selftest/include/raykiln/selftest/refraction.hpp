// Where glass sends rays: T14, T15. Both compare pictures of equal paths, so neither Fresnel's
// formula nor the light model enters.
#pragma once

#include "raykiln/selftest/measure.hpp"

namespace raykiln::render::selftest {

/// T14: deviation 2 asin(n sin(A/2)) - A of a prism at minimum deviation: every path that passes
/// both faces meets an emitter that is 1e-5 rad wide to either side of that direction.
[[nodiscard]] Outcome prism_deviation(double index, double apex_rad, std::uint64_t samples);

/// Shift of a ray by a slab of thickness 1: sin(th) (1 - cos(th)/sqrt(n^2 - sin^2(th))).
[[nodiscard]] double slab_shift(double index, double angle_rad);

/// T15: an edge seen through a slab stands where the shift puts it, to a quarter of a pixel.
[[nodiscard]] Outcome slab_displacement(double index, double angle_rad, std::uint64_t samples);

}  // namespace raykiln::render::selftest
