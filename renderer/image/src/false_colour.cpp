#include "raykiln/image/false_colour.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "raykiln/math/srgb.hpp"

namespace raykiln::render {
namespace {

constexpr double kDecades = 1e-3;
constexpr double kPercentile = 0.999;

/// Linear RGB at equal steps: luminance rises from step to step.
constexpr std::array<std::array<double, 3>, 6> kColours{{{0.004, 0.004, 0.045},
                                                         {0.030, 0.030, 0.240},
                                                         {0.020, 0.160, 0.260},
                                                         {0.040, 0.380, 0.130},
                                                         {0.520, 0.620, 0.040},
                                                         {1.000, 0.920, 0.500}}};
constexpr std::array<double, 3> kUnknown{1.0, 0.0, 1.0};

/// The next number above that is 1, 2 or 5 times a power of ten.
double round_up(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double step : {1.0, 2.0, 5.0}) {
    if (value <= step * power * (1.0 + 1e-9)) return step * power;
  }
  return 10.0 * power;
}

double position(double value, const ValueRange& range) {
  double t = 0.0;
  if (range.scale == ValueScale::kLinear) t = (value - range.low) / (range.high - range.low);
  else if (value > 0.0) t = std::log(value / range.low) / std::log(range.high / range.low);
  return std::clamp(t, 0.0, 1.0);
}

std::array<double, 3> colour(double t) {
  const double at = t * static_cast<double>(kColours.size() - 1);
  const auto step = std::min(static_cast<std::size_t>(at), kColours.size() - 2);
  const double rest = at - static_cast<double>(step);
  std::array<double, 3> mixed{};
  for (std::size_t c = 0; c < 3; ++c) {
    mixed[c] = (1.0 - rest) * kColours[step][c] + rest * kColours[step + 1][c];
  }
  return mixed;
}

}  // namespace

std::string_view name(ValueScale scale) { return scale == ValueScale::kLog ? "log" : "linear"; }

ValueRange value_range(std::span<const float> values, ValueScale scale) {
  std::vector<float> finite;
  std::copy_if(values.begin(), values.end(), std::back_inserter(finite),
               [](float v) { return std::isfinite(v) && v > 0.0F; });
  ValueRange range{.low = 0.0, .high = 1.0, .scale = scale};
  if (!finite.empty()) {
    const double share = scale == ValueScale::kLog ? kPercentile : 1.0;
    const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(finite.size() - 1));
    std::nth_element(finite.begin(), finite.begin() + at, finite.end());
    range.high = round_up(static_cast<double>(finite[static_cast<std::size_t>(at)]));
  }
  if (scale == ValueScale::kLog) range.low = kDecades * range.high;
  return range;
}

Image false_colour(std::span<const float> values, int width, int height, const ValueRange& range) {
  Image image{.width = width, .height = height, .rgb = std::vector<float>(3 * values.size())};
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto value = static_cast<double>(values[i]);
    const auto rgb = std::isnan(value) ? kUnknown : colour(position(value, range));
    for (std::size_t c = 0; c < 3; ++c) image.rgb[3 * i + c] = static_cast<float>(rgb[c]);
  }
  return image;
}

Image direction_colours(std::span<const float> directions, int width, int height) {
  Image image{.width = width, .height = height, .rgb = std::vector<float>(directions.size())};
  for (std::size_t i = 0; i < directions.size(); i += 3) {
    const auto* d = &directions[i];
    if (d[0] == 0.0F && d[1] == 0.0F && d[2] == 0.0F) continue;
    for (std::size_t c = 0; c < 3; ++c) {
      const double display = std::clamp(0.5 + 0.5 * static_cast<double>(d[c]), 0.0, 1.0);
      image.rgb[i + c] = static_cast<float>(linear_of_srgb(display));
    }
  }
  return image;
}

// Steps of the golden section go round the circle of hues without coming near an earlier one soon.
Image id_colours(std::span<const float> ids, int width, int height) {
  constexpr double kGolden = 0.61803398874989485;
  Image image{.width = width, .height = height, .rgb = std::vector<float>(3 * ids.size())};
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (ids[i] == 0.0F) continue;
    const double turns = kGolden * static_cast<double>(ids[i]);
    for (std::size_t c = 0; c < 3; ++c) {
      const double phase = turns - std::floor(turns) + static_cast<double>(c) / 3.0;
      const double wave = 0.5 + 0.5 * std::cos(6.283185307179586 * phase);
      image.rgb[3 * i + c] = static_cast<float>(linear_of_srgb(0.15 + 0.8 * wave));
    }
  }
  return image;
}

}  // namespace raykiln::render
