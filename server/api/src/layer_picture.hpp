// What a PNG of a layer shows.
#pragma once

#include <string>

#include "raykiln/image/false_colour.hpp"
#include "raykiln/scheduler/views.hpp"

namespace raykiln::server {

enum class LayerLook {
  kUnknown,  ///< there is no such layer
  kLight,    ///< the picture, or a part of its light, or albedo: shown as a picture is
  kMap,      ///< one value a pixel, in false colour with a range
  kOther,    ///< directions and numbers, in colours of their own
};
[[nodiscard]] LayerLook look_of(const std::string& layer);
/// "beauty, error, ...": for messages.
[[nodiscard]] std::string layer_choices();

/// Whether the picture has it.
[[nodiscard]] bool has_layer(const JobImage& image, const std::string& layer);

/// Of a layer that it has: linear values for encode_png().
[[nodiscard]] render::Image layer_picture(const JobImage& image, const std::string& layer);

/// What the colours of a kMap stand for.
[[nodiscard]] render::ValueRange layer_range(const JobImage& image, const std::string& layer);

}  // namespace raykiln::server
