// Diffuse squares that light each other: T05, T06, T07.
#pragma once

#include "raykiln/selftest/measure.hpp"

namespace raykiln::render::selftest {

/// Configuration factor of the rectangle [x0, x1] x [y0, y1] at height h over a level element at
/// the origin (corner formula with signs; Howell's catalogue B-3).
[[nodiscard]] double element_to_rectangle(double x0, double x1, double y0, double y1, double h);

/// Form factor from the w x l to the h x l rectangle at a right angle along the edge l (Howell's
/// catalogue C-14).
[[nodiscard]] double perpendicular_rectangles(double w, double h, double l);

struct SquareOverElement {
  double albedo = 0.8, radiance = 1.0;
  double side = 1.0, height = 1.0;
  double x = 0.0, y = 0.0;  ///< of the element from the point under the square's centre
  LightModel model = kPhysicalModel;
};

/// T05: first bounce from a square emitter onto one point: L = a Le F. `emitter_sampling` chooses
/// the estimator.
[[nodiscard]] Outcome square_over_element(const SquareOverElement& input, bool emitter_sampling,
                                          std::uint64_t samples);

struct ParallelSquares {
  double emission = 1.0, albedo_1 = 0.5, albedo_2 = 0.8;
  double distance = 1.0;  ///< of the unit squares
  LightModel model = kPhysicalModel;
};

/// Radiances of the plates by the integral equation: Gauss-Legendre Nystroem, 16 points an axis.
struct PlateRadiances {
  double mean_1 = 0.0, mean_2 = 0.0, centre_1 = 0.0, centre_2 = 0.0;
};
[[nodiscard]] PlateRadiances parallel_squares_truth(const ParallelSquares& input);

/// T06: mean radiance of a plate (1 the emitter, 2 the other).
[[nodiscard]] Outcome parallel_squares(const ParallelSquares& input, int plate,
                                       std::uint64_t samples);

struct TouchingRectangles {
  double receiver = 1.0, emitter = 1.0, edge = 1.0;  ///< widths, and the length of the common edge
  LightModel model = kPhysicalModel;
};

/// T07 and L07: a white receiver lit by an emitter at a right angle, first bounce: mean L = F.
[[nodiscard]] Measured touching_rectangles_picture(const TouchingRectangles& input,
                                                   bool emitter_sampling, std::uint64_t samples,
                                                   std::uint64_t seed = 0);
[[nodiscard]] Outcome touching_rectangles(const TouchingRectangles& input, bool emitter_sampling,
                                          std::uint64_t samples);

}  // namespace raykiln::render::selftest
