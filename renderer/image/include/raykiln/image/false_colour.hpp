// One value a pixel as a picture for people, with the range that its colours stand for.
#pragma once

#include <span>
#include <string_view>

#include "raykiln/image/film.hpp"

namespace raykiln::render {

enum class ValueScale { kLinear, kLog };
[[nodiscard]] std::string_view name(ValueScale scale);  ///< "linear", "log"

/// Values at the dark and the bright end of the colours.
struct ValueRange {
  double low = 0.0, high = 1.0;
  ValueScale scale = ValueScale::kLinear;
};

/// From 0 to the largest value, or three decades below the 99.9th percentile; ends at 1, 2 or 5 times a
/// power of ten, so that a range changes seldom. Values that are not finite are left out.
[[nodiscard]] ValueRange value_range(std::span<const float> values, ValueScale scale);

/// Dark blue, over green, to yellow, brightness rising; NaN (unknown) is magenta. To be encoded with
/// encode_png at exposure 0. Precondition: width x height values.
[[nodiscard]] Image false_colour(std::span<const float> values, int width, int height,
                                 const ValueRange& range);

/// Directions, 3 values a pixel: -1 to 1 become the display values 0 to 1; (0, 0, 0), no direction, is black.
[[nodiscard]] Image direction_colours(std::span<const float> directions, int width, int height);

/// A bright colour for each number, neighbours far apart in hue; 0 is black.
[[nodiscard]] Image id_colours(std::span<const float> ids, int width, int height);

}  // namespace raykiln::render
