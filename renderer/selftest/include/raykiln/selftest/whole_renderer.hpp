// Checks of everything together: furnaces (T01, T02), trees and edges (K01, V03), scale, tree and
// light (X01, X03, X04), bad, many and close samples (M03-M05).
#pragma once

#include "raykiln/selftest/measure.hpp"

namespace raykiln::render::selftest {

/// A closed room with every kind of surface and light.
[[nodiscard]] Scene room_of_all_kinds();

/// T01: a closed box that emits 1 - albedo and reflects the rest: 1 everywhere.
[[nodiscard]] Outcome white_furnace(double albedo, const LightModel& model);
/// T02: the same cut at `depth` reflections: 1 - albedo^(depth + 1).
[[nodiscard]] Outcome truncated_furnace(double albedo, int depth);

/// K01: rays against a wall of triangles in one plane; every ray hits, as by brute force.
[[nodiscard]] Outcome coplanar_wall(int rays);
/// V03, V04: rays at the edges and corners of a closed mesh from inside: none gets out.
[[nodiscard]] Outcome sealed_edges(int rays);

[[nodiscard]] Outcome same_at_any_scale();  ///< X01
[[nodiscard]] Outcome same_for_any_tree();  ///< X03
[[nodiscard]] Outcome linear_in_light();    ///< X04

/// M03: NaN and infinite samples are dropped and counted, in this very binary.
[[nodiscard]] Outcome bad_samples_counted();
/// M04: a million ones in one pixel.
[[nodiscard]] Outcome a_million_samples();
/// M05: the variance of samples that differ in their sixth digit.
[[nodiscard]] Outcome variance_of_close_samples();

}  // namespace raykiln::render::selftest
