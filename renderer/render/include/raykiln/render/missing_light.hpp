// Light that no number of samples brings, with its size: told apart from noise, and never added to it.
#pragma once

#include <cstdint>
#include <stop_token>
#include <vector>

#include "raykiln/render/render.hpp"

namespace raykiln::render {

/// From pairs of samples that share their random numbers, one as the settings have it, one with what
/// they leave out. Means over the picture and its channels, radiance.
struct MissingLight {
  std::uint64_t probes = 0;     ///< pairs; 0: nothing to find out, or too dear
  std::uint64_t differing = 0;  ///< whose two samples are not the same
  double mean = 0.0;            ///< with what is left out
  double missing = 0.0, standard_error = 0.0;  ///< of that mean, and of `missing`
  [[nodiscard]] double share() const { return mean > 0.0 ? missing / mean : 0.0; }
  [[nodiscard]] double share_error() const { return mean > 0.0 ? standard_error / mean : 0.0; }
};

/// Pairs that settings allow: as many as about 1e5 rays pay for, 1024 at most. Fewer are traced where rays
/// are dear, so that all of it takes a fraction of a second.
[[nodiscard]] std::uint64_t affordable_probes(const PreparedScene& scene, const RenderSettings& settings);

/// What the limit of the paths' length cuts off: the other sample goes on and is ended by roulette.
/// Tests nothing (0 probes) where roulette ends paths and the limit is not below kRouletteLimit, nor where stop is
/// requested before what paths need of the scene has been made.
[[nodiscard]] MissingLight cut_off_light(const PreparedScene& scene, const RenderSettings& settings,
                                         std::uint64_t probes, const std::stop_token& stop = {});

/// Light of emitters and of the environment that paths seldom find by themselves, where a picture is to do without emitter
/// sampling: the other sample has it. Its mean is the same; what is missing is what so few samples have
/// not found.
[[nodiscard]] MissingLight unseen_light(const PreparedScene& scene, const RenderSettings& settings,
                                        std::uint64_t probes, const std::stop_token& stop = {});

/// Both as notices: "truncated_paths" where the limit may cost a thousandth of the light, and
/// "unseen_light" where paths alone miss light by more than 3 standard errors, with what `3/n` of the
/// brightest emitter can still add. Precondition: settings_error() is nothing.
[[nodiscard]] std::vector<RenderNotice> missing_light_notices(const PreparedScene& scene,
                                                              const RenderSettings& settings,
                                                              const std::stop_token& stop = {});

}  // namespace raykiln::render
