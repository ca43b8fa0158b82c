// Point lights over planes and sheets: T03, T04, T16, T20.
#pragma once

#include "raykiln/selftest/measure.hpp"

namespace raykiln::render::selftest {

struct LightOverPlane {
  double albedo = 0.8, intensity = 10.0;  ///< reflectance; W/sr
  double height = 2.0, distance = 1.0;    ///< of the light over the plane; of the point from its foot
  double azimuth_rad = 0.0;               ///< direction from the foot to the point
  LightModel model = kPhysicalModel;
};

/// T03: L = (a/pi) I h/(h^2 + d^2)^(3/2), to 1e-5.
[[nodiscard]] Outcome light_over_plane(const LightOverPlane& input);

/// T04: mean over the square of half-side s about the foot: (a/pi) I Omega/(4 s^2) with
/// Omega = 4 atan(s^2/(h sqrt(h^2 + 2 s^2))). `distance` is s.
[[nodiscard]] Outcome light_over_square(const LightOverPlane& input, std::uint64_t samples);

/// T16: a sheet that scatters alike to both sides, seen from each: L = a/(2 pi) I/h^2 at the foot.
[[nodiscard]] Outcome translucent_sheet(const LightOverPlane& input);

struct Umbra {
  double light = 3.0, occluder = 1.0;  ///< heights over the floor
  double half = 0.5;                   ///< half-side of the occluder
  int pixels = 64;                     ///< side of the picture
  LightModel model = kPhysicalModel;
};

/// T20: inside half * light/(light - occluder) exactly 0, outside the formula of T03, but for one
/// pixel on either side.
[[nodiscard]] Outcome umbra_of_square(const Umbra& input);

}  // namespace raykiln::render::selftest
