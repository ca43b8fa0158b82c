// How much of the scatter between neighbours is noise.
#pragma once

#include <vector>

#include "windows.hpp"

namespace raykiln::render {

/// For each pixel: the mean of the variances of `values` in its window over their scatter there, at
/// most 1; 1 where nothing scatters, 0 where it is alone. value + share (mean of the window - value)
/// is then its best linear estimate (Lee 1980, "Digital image enhancement and noise filtering"): where
/// all scatter is noise the window speaks, at an edge the pixel itself.
[[nodiscard]] std::vector<double> noise_shares(const std::vector<double>& values,
                                               const std::vector<double>& variances,
                                               const Windows& windows);

}  // namespace raykiln::render
