// Closed rooms whose light is a series of reflections: T01, T02, T08, T09.
#pragma once

#include "raykiln/selftest/measure.hpp"

namespace raykiln::render::selftest {

/// What stands in the furnace; none of it absorbs.
enum class FurnaceGuest { kNone, kGlass, kMirror, kLeaf };

/// T01: every wall emits 1 - albedo and reflects albedo: radiance 1 everywhere, with anything
/// lossless inside.
[[nodiscard]] Outcome furnace(double albedo, FurnaceGuest guest, const LightModel& model,
                              std::uint64_t samples);

/// T02: after `depth` reflections E (1 - albedo^(depth + 1))/(1 - albedo); to 1e-5 with
/// cosine-weighted directions, which leave no noise, else 4 sigma.
[[nodiscard]] Outcome truncated_furnace(double albedo, int depth, const LightModel& model,
                                        std::uint64_t samples);

/// T08: sphere of radius 1 with a point light I = pi in its centre: albedo/(1 - albedo). A mesh of
/// 64 x 128; 0.2 % are allowed for it.
[[nodiscard]] Outcome sphere_with_light(double albedo, const LightModel& model,
                                        std::uint64_t samples);

/// T09: sphere with an emitting cap of radiance 2 over the share f of its area. The wall has
/// albedo f Le/(1 - albedo), or over 1 - albedo (1 - f) if the cap is black. f of the mesh is exact;
/// 0.3 % are allowed for its not being a sphere.
[[nodiscard]] Outcome sphere_with_cap(double albedo, bool black_cap, const LightModel& model,
                                      std::uint64_t samples);

}  // namespace raykiln::render::selftest
