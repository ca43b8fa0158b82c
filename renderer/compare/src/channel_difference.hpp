// Difference of one channel, with the noise that is to be expected of it.
#pragma once

#include <vector>

#include "raykiln/compare/measured_image.hpp"

namespace raykiln::render {

/// Per pixel, row-major.
struct ChannelDifference {
  int width = 0, height = 0;
  std::vector<double> difference;  ///< render - reference; 0 where rounding to float explains it
  std::vector<double> variance;    ///< of the difference, estimated without it; 0 for noise-free pixels
  std::vector<double> scale;       ///< what a self-normalised sum is divided by: see README.md
  std::vector<double> weight;      ///< does not depend on this pixel's own samples
};

[[nodiscard]] ChannelDifference channel_difference(const MeasuredImage& render,
                                                   const MeasuredImage& reference, int channel);

}  // namespace raykiln::render
