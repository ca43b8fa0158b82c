#include "channel_difference.hpp"

#include <algorithm>
#include <cmath>

namespace raykiln::render {
namespace {

/// Weights come from the pixels at a distance of 2 and 3. An error layer may pool 3 x 3 pixels, so that
/// nearer ones could know this pixel's own samples.
constexpr int kNear = 2, kFar = 3;
constexpr double kWeightFloor = 0.01;    ///< of the median variance
constexpr double kRounding = 0x1p-22;    ///< both means were rounded to float: 2^-24 each, with room

struct PixelMean {
  double mean, error, samples;
};

PixelMean at(const MeasuredImage& image, std::size_t pixel, int channel) {
  const std::size_t value = 3 * pixel + static_cast<std::size_t>(channel);
  const double mean = static_cast<double>(image.mean.rgb[value]);
  const double error = static_cast<double>(image.error[value]);
  // An error that is not known is what one sample has: the difference itself then stands for it.
  if (!std::isfinite(error)) return {mean, 0.0, 1.0};
  return {mean, error, std::max(1.0, static_cast<double>(image.samples[pixel]))};
}

/// Sum of squared deviations behind a standard error e of n samples: e^2 n (n - 1).
double squared_deviations(const PixelMean& p) {
  return p.error * p.error * p.samples * (p.samples - 1.0);
}

/// The larger of two estimates. Pooled (Student 1908): under the null hypothesis both pictures
/// sample one distribution, and the longer render knows of rare bright paths that the shorter one
/// missed. Separate (Welch 1938): a bright path that only one picture met counts in full.
double difference_variance(const PixelMean& a, const PixelMean& b) {
  const double separate = a.error * a.error + b.error * b.error;
  const double degrees = a.samples + b.samples - 2.0;
  if (degrees <= 0.0) return separate;
  const double per_sample = (squared_deviations(a) + squared_deviations(b)) / degrees;
  return std::max(separate, per_sample * (1.0 / a.samples + 1.0 / b.samples));
}

double median_of_positive(const std::vector<double>& values) {
  std::vector<double> positive;
  std::copy_if(values.begin(), values.end(), std::back_inserter(positive), [](double v) { return v > 0.0; });
  if (positive.empty()) return 1.0;
  const auto middle = positive.begin() + static_cast<std::ptrdiff_t>(positive.size() / 2);
  std::nth_element(positive.begin(), middle, positive.end());
  return *middle;
}

/// Mean of the plane over a ring around each pixel; 0 where the picture has none of it.
std::vector<double> ring_means(const std::vector<double>& plane, int width, int height) {
  std::vector<double> means(plane.size());
  const auto w = static_cast<std::size_t>(width);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      double sum = 0.0;
      int count = 0;
      for (int ny = std::max(0, y - kFar); ny <= std::min(height - 1, y + kFar); ++ny) {
        for (int nx = std::max(0, x - kFar); nx <= std::min(width - 1, x + kFar); ++nx) {
          if (std::max(std::abs(nx - x), std::abs(ny - y)) < kNear) continue;
          sum += plane[static_cast<std::size_t>(ny) * w + static_cast<std::size_t>(nx)];
          ++count;
        }
      }
      means[static_cast<std::size_t>(y) * w + static_cast<std::size_t>(x)] = count > 0 ? sum / count : 0.0;
    }
  }
  return means;
}

}  // namespace

ChannelDifference channel_difference(const MeasuredImage& render, const MeasuredImage& reference,
                                     int channel) {
  const std::size_t pixels = render.pixels();
  ChannelDifference result{.width = render.mean.width,
                           .height = render.mean.height,
                           .difference = std::vector<double>(pixels),
                           .variance = std::vector<double>(pixels),
                           .scale = std::vector<double>(pixels),
                           .weight = {}};
  for (std::size_t i = 0; i < pixels; ++i) {
    const PixelMean a = at(render, i, channel), b = at(reference, i, channel);
    const double difference = a.mean - b.mean;
    const double variance = difference_variance(a, b);
    if (!std::isfinite(difference) || !std::isfinite(variance)) continue;  // counted by the caller
    const bool rounding = std::abs(difference) <= kRounding * std::max(std::abs(a.mean), std::abs(b.mean));
    result.difference[i] = rounding ? 0.0 : difference;
    result.variance[i] = variance;
    const double n = std::min(a.samples, b.samples);
    result.scale[i] = variance * ((n - 1.0) / n) + result.difference[i] * result.difference[i] / n;
  }
  result.weight = ring_means(result.variance, result.width, result.height);
  const double floor = kWeightFloor * median_of_positive(result.variance);
  for (double& weight : result.weight) weight = 1.0 / std::sqrt(weight + floor);
  return result;
}

}  // namespace raykiln::render
