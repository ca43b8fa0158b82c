// Plane borders of glass: T12, T13, T17.
#pragma once

#include "raykiln/selftest/measure.hpp"

namespace raykiln::render::selftest {

/// Transmittance of a slab: (1 - F)/(1 + F), or after `round_trips` reflections back and forth
/// inside, (1 - F)^2 (1 - F^(2K + 2))/(1 - F^2).
[[nodiscard]] double slab_transmittance(double reflectance, int round_trips);

/// T12: slab before a backdrop of 1, black in front. `round_trips` < 0: all of them. F by the
/// model's own formula in closed form.
[[nodiscard]] Outcome slab(double index, double angle_rad, int round_trips, const LightModel& model,
                           std::uint64_t samples);

/// T13: looking up from under water, `side` pixels across: the bright disc has radius h tan(asin(1/n)), to a pixel.
[[nodiscard]] Outcome window_from_below(double index, const LightModel& model, int side = 128);

/// Average reflectance of a border from the rare side over directions of a diffuse emitter.
[[nodiscard]] double average_reflectance(double index, FresnelFormula formula);

/// T17: share of the flux of a diffuse emitter inside glass that leaves through a plane:
/// (1 - average F)/n^2 where radiance is scaled, else 1 - average F. Collected by a white patch.
[[nodiscard]] Outcome flux_out_of_glass(double index, const LightModel& model,
                                        std::uint64_t samples);

/// D09: radiance seen head on through one border, from inside (`outwards` false) or outside.
[[nodiscard]] Outcome radiance_across_border(double index, bool camera_inside,
                                             const LightModel& model, std::uint64_t samples);

}  // namespace raykiln::render::selftest
