// Mirrors and the Phong lobe: T10, T11, T19.
#pragma once

#include "raykiln/selftest/measure.hpp"

namespace raykiln::render::selftest {

struct Corridor {
  double k_a = 0.9, k_b = 0.8;  ///< reflectances of the facing mirrors
  double e_a = 0.3, e_b = 0.05; ///< their emission
};

/// T10: the mirror A seen along its normal, after `depth` reflections; 128 stands for the limit
/// (E_A + k_A E_B)/(1 - k_A k_B). 1e-4 and 4 sigma.
[[nodiscard]] Outcome mirror_corridor(const Corridor& input, int depth, const LightModel& model,
                                      std::uint64_t samples);

/// T11: radiance of a plane with a Phong lobe alone in surroundings of 1, seen at an angle. `truth`
/// from the table of albedos.
[[nodiscard]] Outcome lobe_in_furnace(double exponent, double angle_rad, double truth,
                                      double relative_bias, const LightModel& model,
                                      std::uint64_t samples);

/// T19: mirror image of a point light I = 10 at 3 from a mirror, seen from 2: the sum over pixels of
/// radiance times solid angle. `truth` is near I/(2 + 3)^2.
[[nodiscard]] Outcome mirror_image(double exponent, double truth, const LightModel& model,
                                   std::uint64_t samples);

}  // namespace raykiln::render::selftest
