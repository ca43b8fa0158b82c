#include "raykiln/accuracy/pixel_error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pixel_statistics.hpp"

namespace raykiln::render {
namespace {

std::size_t pixels_of(const Film& film) {
  return static_cast<std::size_t>(film.width()) * static_cast<std::size_t>(film.height());
}

/// Variance of one channel of one pixel, or that it is unknown.
struct Variance {
  double value = 0.0;
  double spread = 0.0;  ///< relative standard error of it, at most
  bool known = false;
};

Variance variance_of(const PixelStatistics& pixel, double value) {
  return {.value = value, .spread = std::sqrt(pixel.largest_share), .known = pixel.known};
}

/// store(i, standard error) for every pixel. The mean of the window is used, in which a pixel's own
/// lucky or unlucky samples weigh little, unless the pixel's variance is above it beyond doubt.
template <typename Store>
void pooled_errors(const std::vector<Variance>& variances, int width, int height, Store store) {
  constexpr int kRadius = 1;
  constexpr double kBeyondDoubt = 2.0;  ///< standard errors
  std::vector<double> known(variances.size()), sums(variances.size());
  for (std::size_t i = 0; i < variances.size(); ++i) {
    known[i] = variances[i].known ? 1.0 : 0.0;
    sums[i] = variances[i].known ? variances[i].value : 0.0;
  }
  known = window_sums(known, width, height, kRadius);
  sums = window_sums(sums, width, height, kRadius);
  for (std::size_t i = 0; i < variances.size(); ++i) {
    const Variance& own = variances[i];
    const double pooled = sums[i] / known[i];
    const bool stands_out = own.value > pooled * (1.0 + kBeyondDoubt * own.spread);
    store(i, own.known ? std::sqrt(stands_out ? own.value : pooled)
                       : std::numeric_limits<double>::quiet_NaN());
  }
}

}  // namespace

PixelErrors pixel_errors(const Film& film) {
  const std::size_t pixels = pixels_of(film);
  PixelErrors result{.width = film.width(),
                     .height = film.height(),
                     .mean = std::vector<double>(3 * pixels),
                     .standard_error = std::vector<double>(3 * pixels)};
  std::array<std::vector<Variance>, 3> variances;
  variances.fill(std::vector<Variance>(pixels));
  for (std::size_t i = 0; i < pixels; ++i) {
    const PixelStatistics pixel = pixel_statistics(film.pixel(i));
    for (std::size_t c = 0; c < 3; ++c) {
      result.mean[3 * i + c] = pixel.mean[c];
      variances[c][i] = variance_of(pixel, pixel.variance[c]);
    }
  }
  for (std::size_t c = 0; c < 3; ++c) {
    pooled_errors(variances[c], film.width(), film.height(),
                  [&](std::size_t i, double error) { result.standard_error[3 * i + c] = error; });
  }
  return result;
}

std::vector<float> luminance_errors(const Film& film) {
  const std::size_t pixels = pixels_of(film);
  std::vector<Variance> variances(pixels);
  for (std::size_t i = 0; i < pixels; ++i) {
    const PixelStatistics pixel = pixel_statistics(film.pixel(i));
    variances[i] = variance_of(pixel, pixel.luminance_variance);
  }
  std::vector<float> result(pixels);
  pooled_errors(variances, film.width(), film.height(),
                [&](std::size_t i, double error) { result[i] = static_cast<float>(error); });
  return result;
}

}  // namespace raykiln::render
