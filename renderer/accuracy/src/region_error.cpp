#include "region_error.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "raykiln/accuracy/image_error.hpp"
#include "raykiln/image/display.hpp"
#include "smoothed_means.hpp"

namespace raykiln::render {
namespace {

constexpr int kWindowRadius = 2;
constexpr double kFewEvents = 15.0;  ///< samples that make up the variance of 3 x 3 pixels: too few below
constexpr std::array<double, 3> kLuminance{0.2126, 0.7152, 0.0722};

void set(SquaredError& e, std::size_t c, double mean) {
  e.mean[c] = mean;
  e.spread[c] = std::numbers::sqrt2 * mean;
}

/// (d(x + s z) - d(x))^2 for z normal, by Gauss-Hermite quadrature with three nodes. Its spread is
/// sqrt(2) times its mean where d is straight, more where it bends.
void set_display(SquaredError& e, std::size_t c, double x, double standard_error, double gain) {
  const double step = std::sqrt(3.0) * standard_error * gain, at = gain * x;
  const double middle = display_value(at);
  const double up = display_value(at + step) - middle, down = display_value(at - step) - middle;
  const double u2 = up * up, d2 = down * down, mean = (u2 + d2) / 6.0;
  e.mean[c] = mean;
  e.spread[c] = std::sqrt(std::max(0.0, (u2 * u2 + d2 * d2) / 6.0 - mean * mean));
}

/// A core with the pixels around that its windows reach.
struct Region {
  std::vector<PixelStatistics> pixels;
  int width, height;
  PixelRect core;  ///< in pixels of the region

  Region(const Film& film, const PixelRect& inner, int margin) {
    const int x0 = std::max(0, inner.x0 - margin), x1 = std::min(film.width(), inner.x1 + margin);
    const int y0 = std::max(0, inner.y0 - margin), y1 = std::min(film.height(), inner.y1 + margin);
    width = x1 - x0;
    height = y1 - y0;
    core = {inner.x0 - x0, inner.y0 - y0, inner.x1 - x0, inner.y1 - y0};
    pixels.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    for (int y = y0; y < y1; ++y) {
      const auto row = static_cast<std::size_t>(y) * static_cast<std::size_t>(film.width());
      for (int x = x0; x < x1; ++x) pixels.push_back(pixel_statistics(film, row + static_cast<std::size_t>(x)));
    }
  }
  [[nodiscard]] Windows windows(int radius) const { return {width, height, radius}; }
};

/// relative[i] summed over the core's pixels whose 3 x 3 window owes its error to few samples. m samples of
/// equal weight in a window give (sum a)^2 / sum (a largest_share)^2 = m if each is in another pixel.
double in_tails(const Region& region, const SquaredErrors& relative) {
  std::vector<double> sums(relative.size()), squares(relative.size());
  for (std::size_t i = 0; i < relative.size(); ++i) {
    sums[i] = relative[i].total();
    const double of_one = sums[i] * region.pixels[i].largest_share;
    squares[i] = of_one * of_one;
  }
  const Windows windows = region.windows(1);
  const auto all = windows.sums(sums), ones = windows.sums(squares);
  double result = 0.0;
  windows.each(region.core, [&](std::size_t i) {
    const bool few = all[i] * all[i] < kFewEvents * ones[i];
    if (few && region.pixels[i].samples >= kSampleFloor) result += sums[i];
  });
  return result;
}

}  // namespace

void Survey::add(const PixelStatistics& p) {
  ++pixels;
  unsampled += p.samples == 0 ? 1U : 0U;
  unknown += p.known ? 0U : 1U;
  least = std::min(least, p.samples);
  samples_ += static_cast<double>(p.samples);
  mean_ += p.mean[0] + p.mean[1] + p.mean[2];
  std::array<double, 3> weighted{};
  for (std::size_t c = 0; c < 3; ++c) {
    weighted[c] = kLuminance[c] * std::sqrt(p.variance[c]);
    apart_ += weighted[c] * weighted[c];
    variance_ += p.variance[c];
  }
  together_ += 2.0 * (weighted[0] * weighted[1] + weighted[0] * weighted[2] + weighted[1] * weighted[2]);
  luminance_variance_ += p.luminance_variance;
}

double Survey::correlation() const {
  return together_ > 0.0 ? std::clamp((luminance_variance_ - apart_) / together_, 0.0, 1.0) : 1.0;
}

void add_region(Totals& totals, const Film& film, const PixelRect& core, int margin, const Survey& survey, double gain) {
  const Region region(film, core, margin);
  const Windows windows = region.windows(kWindowRadius);
  const auto means = smoothed_means(region.pixels, windows);
  const double correlation = survey.correlation();
  SquaredErrors errors(region.pixels.size());
  const auto tally = [&](Tally& into, auto set_error) {
    for (std::size_t i = 0; i < errors.size(); ++i) {
      errors[i] = {};
      for (std::size_t c = 0; c < 3; ++c) {
        const double variance = region.pixels[i].variance[c];
        if (variance > 0.0) set_error(errors[i], c, means[c][i], variance);
      }
    }
    add(into, errors, region.pixels, windows, correlation, region.core);
  };
  tally(totals.linear, [](SquaredError& e, std::size_t c, double, double variance) { set(e, c, variance); });
  tally(totals.display, [gain](SquaredError& e, std::size_t c, double mean, double variance) {
    set_display(e, c, mean, std::sqrt(variance), gain);
  });
  const double floor = survey.floor();
  tally(totals.relative, [floor](SquaredError& e, std::size_t c, double mean, double variance) {
    set(e, c, variance / (mean * mean + floor));
  });
  totals.tails += in_tails(region, errors);  // the relative ones
}

NoiseSum noise_of_one_sample(const Film& film, const PixelRect& core, double floor) {
  const Region region(film, core, kWindowRadius);
  const auto means = smoothed_means(region.pixels, region.windows(kWindowRadius));
  NoiseSum sum;
  region.windows(kWindowRadius).each(region.core, [&](std::size_t i) {
    const PixelStatistics& pixel = region.pixels[i];
    double squares = 0.0;
    for (std::size_t c = 0; c < 3; ++c) {
      if (pixel.variance[c] > 0.0) squares += pixel.variance[c] / (means[c][i] * means[c][i] + floor);
    }
    squares *= static_cast<double>(pixel.samples);
    sum.value += squares;
    sum.variance += pixel.scatter * squares * squares;
  });
  return sum;
}

}  // namespace raykiln::render
