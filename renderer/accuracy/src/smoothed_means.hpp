// The means of pixels as they would be without noise, as far as their neighbours can tell.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "pixel_statistics.hpp"
#include "windows.hpp"

namespace raykiln::render {

/// Each channel of each pixel, for denominators: 1/x^2 of a noisy x is too large by 3 v/x^4, and far
/// too small where one sample that makes up the variance also lifts x. So
/// - the light of a pixel's largest sample is replaced by what the largest samples of its neighbours
///   bring, which keeps the energy of the window and takes its noise apart from the pixel's variance;
/// - the rest is drawn towards the neighbours by noise_shares().
[[nodiscard]] std::array<std::vector<double>, 3> smoothed_means(std::span<const PixelStatistics> pixels,
                                                                const Windows& windows);

}  // namespace raykiln::render
