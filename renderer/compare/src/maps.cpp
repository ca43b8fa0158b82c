#include "raykiln/compare/maps.hpp"

#include <algorithm>
#include <cmath>

#include "block_sums.hpp"

namespace raykiln::render {
namespace {

constexpr double kFullColourZ = 6.0;
constexpr int kMapBlock = 8;  ///< pixels

struct Colour {
  double r, g, b;
};

Colour mix(const Colour& a, const Colour& b, double t) {
  return {a.r + t * (b.r - a.r), a.g + t * (b.g - a.g), a.b + t * (b.b - a.b)};
}

/// -1: blue, 0: `middle`, 1: red; linear values. NaN: yellow.
Colour diverging(double t, const Colour& middle) {
  if (std::isnan(t)) return {0.9, 0.8, 0.0};
  constexpr Colour kRed{0.6, 0.01, 0.02}, kBlue{0.01, 0.07, 0.5};
  return mix(middle, t > 0.0 ? kRed : kBlue, std::min(1.0, std::abs(t)));
}

template <class Value>
Image paint(int width, int height, const Colour& middle, const Value& value) {
  Image image{.width = width, .height = height, .rgb = {}};
  const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  image.rgb.reserve(3 * pixels);
  for (std::size_t i = 0; i < pixels; ++i) {
    const Colour c = diverging(value(i), middle);
    for (const double channel : {c.r, c.g, c.b}) image.rgb.push_back(static_cast<float>(channel));
  }
  return image;
}

double luminance_at(const Image& image, std::size_t pixel) {
  return luminance({static_cast<double>(image.rgb[3 * pixel]), static_cast<double>(image.rgb[3 * pixel + 1]),
                    static_cast<double>(image.rgb[3 * pixel + 2])});
}

/// Sums over the block of kMapBlock pixels around each pixel; two passes of a sliding window would
/// lose digits where one pixel is huge, so every window is added up anew, rows first.
std::vector<BlockSum> window_sums(const CellGrid& pixels) {
  const int before = kMapBlock / 2, after = kMapBlock - before;
  const auto pass = [&](const std::vector<BlockSum>& from, int length, int lines, std::size_t step, std::size_t line_step) {
    std::vector<BlockSum> to(from.size());
    for (int line = 0; line < lines; ++line) {
      for (int i = 0; i < length; ++i) {
        const std::size_t start = static_cast<std::size_t>(line) * line_step;
        BlockSum& sum = to[start + static_cast<std::size_t>(i) * step];
        for (int k = std::max(0, i - before); k < std::min(length, i + after); ++k) {
          sum += from[start + static_cast<std::size_t>(k) * step];
        }
      }
    }
    return to;
  };
  const auto width = static_cast<std::size_t>(pixels.columns);
  return pass(pass(pixels.cells, pixels.columns, pixels.rows, 1, width), pixels.rows, pixels.columns, width, 1);
}

}  // namespace

Image difference_picture(const Image& render, const Image& reference) {
  const std::size_t pixels = render.rgb.size() / 3;
  std::vector<double> signed_difference(pixels), sizes;
  for (std::size_t i = 0; i < pixels; ++i) {
    signed_difference[i] = luminance_at(render, i) - luminance_at(reference, i);
    if (std::isfinite(signed_difference[i])) sizes.push_back(std::abs(signed_difference[i]));
  }
  double full = 0.001;
  if (!sizes.empty()) {
    const auto high = sizes.begin() + static_cast<std::ptrdiff_t>((sizes.size() - 1) * 995 / 1000);
    std::nth_element(sizes.begin(), high, sizes.end());
    full = std::max(full, *high);
  }
  return paint(render.width, render.height, {0.2, 0.2, 0.2},
               [&](std::size_t i) { return signed_difference[i] / full; });
}

Image z_map(const MeasuredImage& render, const MeasuredImage& reference) {
  std::vector<double> z(render.pixels(), 0.0);
  for (int channel = 0; channel < 3; ++channel) {
    const auto sums = window_sums(pixel_cells(channel_difference(render, reference, channel), {}));
    for (std::size_t i = 0; i < z.size(); ++i) {
      const double own = sums[i].z();
      if (std::abs(own) > std::abs(z[i])) z[i] = own;
    }
  }
  return paint(render.mean.width, render.mean.height, {0.9, 0.9, 0.9}, [&](std::size_t i) {
    return std::copysign(std::max(0.0, (std::abs(z[i]) - 1.0) / (kFullColourZ - 1.0)), z[i]);
  });
}

}  // namespace raykiln::render
