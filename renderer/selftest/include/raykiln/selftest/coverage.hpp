// How much of a pixel a half plane covers: T18, F04.
#pragma once

#include "raykiln/selftest/measure.hpp"

namespace raykiln::render::selftest {

/// Points with a x + b y < c; in pixel units, y downwards from the top left corner of the picture.
struct HalfPlane {
  double a = 0.8, b = 0.6, c = 0.7;
};

/// Area of the unit square [0, 1]^2 inside the half plane.
[[nodiscard]] double covered_area(const HalfPlane& half_plane);

/// A picture of `width` x `height` pixels of a half plane of radiance 1 over black.
[[nodiscard]] Scene half_plane_scene(const HalfPlane& half_plane, int width, int height);

/// T18: mean = area and variance a sample = area (1 - area) in a picture of one pixel.
[[nodiscard]] Outcome pixel_coverage(const HalfPlane& half_plane, std::uint64_t samples);

}  // namespace raykiln::render::selftest
