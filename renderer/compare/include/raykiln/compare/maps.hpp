// Pictures for people: where two renders differ. Values are linear, meant for encode_png at exposure 0.
#pragma once

#include "raykiln/compare/measured_image.hpp"

namespace raykiln::render {

/// Signed difference of luminance, grey where equal, red where the render is brighter, blue where it
/// is darker; full colour at the 99.5th percentile of |difference| (but at least 1/1000).
[[nodiscard]] Image difference_picture(const Image& render, const Image& reference);

/// z of the block of 8 x 8 pixels around each pixel, of the channel with the largest |z|: white below
/// 1, full colour at 6. Both must have noise and the same size.
[[nodiscard]] Image z_map(const MeasuredImage& render, const MeasuredImage& reference);

}  // namespace raykiln::render
