// One sample of one pixel once more, by itself: where a value that was not finite came from.
#pragma once

#include "raykiln/render/render.hpp"

namespace raykiln::render {

struct ReplayedSample {
  Rgbd radiance{0.0};      ///< as it would be added to the pixel, finite or not
  bool truncated = false;  ///< the path was cut at the limit while it could go on
  bool dropped = false;    ///< a channel is NaN or does not fit a float32: not added, counted
  RenderStats stats;
};

/// The sample that render_tile() computes for this pixel and sample index with equal arguments.
/// Precondition: settings_error() has no objection; 0 <= x < width, 0 <= y < height.
[[nodiscard]] ReplayedSample replay_sample(const PreparedScene& scene,
                                           const RenderSettings& settings, int x, int y,
                                           std::uint64_t sample);

}  // namespace raykiln::render
