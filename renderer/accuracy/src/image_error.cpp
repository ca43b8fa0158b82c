#include "raykiln/accuracy/image_error.hpp"

#include <algorithm>
#include <cmath>

#include "pixel_statistics.hpp"
#include "raykiln/accuracy/quantiles.hpp"
#include "raykiln/image/display.hpp"

namespace raykiln::render {
namespace {

constexpr int kWindowRadius = 2;  ///< of the windows that means are smoothed over
constexpr int kStripRows = 16;    ///< rows that are worked on at once
constexpr double kTailPixel = 0.45;  ///< largest_share from which on one or two samples make up a variance
constexpr double kTailImage = 0.2;   ///< part of rel_mse in such pixels that raises the flag
constexpr double kTailWidening = 3.0;
constexpr std::array<double, 3> kLuminance{0.2126, 0.7152, 0.0722};

/// A sum over pixels of expected squared errors a, and of the variance of (real - estimated) a.
struct Tally {
  double sum = 0.0, variance = 0.0;
};

/// What is added up over the whole picture.
struct Totals {
  Tally relative, linear, display;
  double tails = 0.0;           ///< relative squares in pixels with a tail
  double squares = 0.0;         ///< of the relative squares: for effective_pixels
  double samples_variance = 0.0, replicates_variance = 0.0;
};

/// First look: counts, the mean, and how far the noise of the channels goes together.
struct Survey {
  std::uint64_t unsampled = 0, unknown = 0, least = UINT64_MAX;
  double samples = 0.0, mean = 0.0, variance = 0.0;
  double correlation = 1.0;  ///< of the noise of two channels, over the picture
};

Survey survey(const Film& film) {
  Survey result;
  const std::size_t pixels =
      static_cast<std::size_t>(film.width()) * static_cast<std::size_t>(film.height());
  double luminance_variance = 0.0, apart = 0.0, together = 0.0;
  for (std::size_t i = 0; i < pixels; ++i) {
    const PixelStatistics p = pixel_statistics(film.pixel(i));
    result.unsampled += p.samples == 0 ? 1U : 0U;
    result.unknown += p.known ? 0U : 1U;
    result.least = std::min(result.least, p.samples);
    result.samples += static_cast<double>(p.samples);
    result.mean += p.mean[0] + p.mean[1] + p.mean[2];
    std::array<double, 3> weighted{};
    for (std::size_t c = 0; c < 3; ++c) {
      weighted[c] = kLuminance[c] * std::sqrt(p.variance[c]);
      apart += weighted[c] * weighted[c];
      result.variance += p.variance[c];
    }
    together += 2.0 * (weighted[0] * weighted[1] + weighted[0] * weighted[2] + weighted[1] * weighted[2]);
    luminance_variance += p.luminance_variance;
  }
  result.mean /= 3.0 * static_cast<double>(pixels);
  result.samples /= static_cast<double>(pixels);
  // Var(Y) = sum w_c^2 v_c + rho sum of 2 w_c w_d sqrt(v_c v_d), solved for rho.
  if (together > 0.0) {
    result.correlation = std::clamp((luminance_variance - apart) / together, 0.0, 1.0);
  }
  return result;
}

/// Adds a pixel whose channels have the expected squared errors `a`. The real square scatters about
/// its expectation by Var = 2 sum_cd rho^2 a_c a_d (normal errors), the estimate by `of_estimate`.
void add(Tally& tally, const std::array<double, 3>& a, double correlation, double of_estimate) {
  const double sum = a[0] + a[1] + a[2];
  const double own = a[0] * a[0] + a[1] * a[1] + a[2] * a[2];
  const double cross = 2.0 * (a[0] * a[1] + a[0] * a[2] + a[1] * a[2]);
  tally.sum += sum;
  tally.variance += 2.0 * (own + correlation * correlation * cross) + of_estimate * sum * sum;
}

/// E of (d(x + s z) - d(x))^2 for z normal, by Gauss-Hermite quadrature with three nodes.
double display_square(double x, double standard_error, double gain) {
  const double step = std::sqrt(3.0) * standard_error * gain, at = gain * x;
  const double middle = display_value(at);
  const double up = display_value(at + step) - middle, down = display_value(at - step) - middle;
  return (up * up + down * down) / 6.0;
}

/// Rows [y0, y1) of the film with as many more around as windows reach.
class Strip {
 public:
  Strip(const Film& film, int y0, int y1)
      : width_(film.width()),
        first_(std::max(0, y0 - kWindowRadius)),
        rows_(std::min(film.height(), y1 + kWindowRadius) - first_) {
    const auto w = static_cast<std::size_t>(width_), pixels = w * static_cast<std::size_t>(rows_);
    const std::size_t offset = static_cast<std::size_t>(first_) * w;
    for (std::size_t i = 0; i < pixels; ++i) pixels_.push_back(pixel_statistics(film.pixel(offset + i)));
    const auto windows = [&](auto&& value) {
      std::vector<double> values(pixels);
      for (std::size_t i = 0; i < pixels; ++i) values[i] = value(pixels_[i]);
      return window_sums(values, width_, rows_, kWindowRadius);
    };
    count_ = windows([](const PixelStatistics&) { return 1.0; });
    luminance_ = windows([](const PixelStatistics& p) { return p.luminance; });
    square_ = windows([](const PixelStatistics& p) { return p.luminance * p.luminance; });
    variance_ = windows([](const PixelStatistics& p) { return p.luminance_variance; });
    for (std::size_t c = 0; c < 3; ++c) {
      mean_[c] = windows([c](const PixelStatistics& p) { return p.mean[c]; });
    }
  }

  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y - first_) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(x);
  }
  [[nodiscard]] const PixelStatistics& pixel(std::size_t i) const { return pixels_[i]; }

  /// The pixel's mean drawn towards that of its window by the share of noise in the scatter between
  /// pixels (Lee 1980): where all scatter is noise the window speaks, at an edge the pixel itself.
  /// 1/x^2 of a noisy x has a bias of 3 v/x^4; this takes most of it away.
  [[nodiscard]] std::array<double, 3> smoothed(std::size_t i) const {
    std::array<double, 3> result = pixels_[i].mean;
    const double n = count_[i], mean = luminance_[i] / n, noise = variance_[i] / n;
    if (n < 2.0 || noise <= 0.0) return result;
    const double scatter = std::max(0.0, square_[i] / n - mean * mean) * n / (n - 1.0);
    const double share = scatter > noise ? noise / scatter : 1.0;
    for (std::size_t c = 0; c < 3; ++c) result[c] += share * (mean_[c][i] / n - result[c]);
    return result;
  }

 private:
  int width_, first_, rows_;
  std::vector<PixelStatistics> pixels_;
  std::vector<double> count_, luminance_, square_, variance_;
  std::array<std::vector<double>, 3> mean_;
};

void add_pixel(Totals& totals, const PixelStatistics& p, const std::array<double, 3>& smoothed,
               const Survey& survey, double gain) {
  std::array<double, 3> relative{}, display{};
  const double floor = 0.01 * survey.mean * survey.mean;
  for (std::size_t c = 0; c < 3; ++c) {
    if (!(p.variance[c] > 0.0)) continue;
    relative[c] = p.variance[c] / (smoothed[c] * smoothed[c] + floor);
    display[c] = display_square(smoothed[c], std::sqrt(p.variance[c]), gain);
  }
  add(totals.relative, relative, survey.correlation, p.largest_share);
  add(totals.linear, p.variance, survey.correlation, p.largest_share);
  add(totals.display, display, survey.correlation, p.largest_share);
  const double sum = relative[0] + relative[1] + relative[2];
  totals.squares += sum * sum;
  if (p.samples >= kSampleFloor && p.largest_share > kTailPixel) totals.tails += sum;
  totals.samples_variance += p.luminance_variance;
  totals.replicates_variance += p.replicate_variance;
}

/// 95 % interval of the mean square, log-normal: it cannot reach below 0.
Figure mean_square(const Tally& tally, double values, double widening) {
  if (!(tally.sum > 0.0)) return {};
  const double spread = kNormal95 * widening * std::sqrt(tally.variance) / tally.sum;
  const double value = tally.sum / values;
  return {.value = value, .low = value * std::exp(-spread), .high = value * std::exp(spread)};
}

Figure root(const Figure& square) {
  return {std::sqrt(square.value), std::sqrt(square.low), std::sqrt(square.high)};
}

}  // namespace

std::string name(ErrorGrade grade) {
  switch (grade) {
    case ErrorGrade::kRough: return "rough";
    case ErrorGrade::kMeasured: return "measured";
    case ErrorGrade::kUnknown: break;
  }
  return "unknown";
}

ImageError image_error(const Film& film, double exposure_stops) {
  ImageError result;
  result.pixels = static_cast<std::uint64_t>(film.width()) * static_cast<std::uint64_t>(film.height());
  if (result.pixels == 0) return result;
  const Survey first = survey(film);
  result.unsampled_pixels = first.unsampled;
  result.least_samples = first.least;
  result.mean_samples = first.samples;
  result.mean = first.mean;
  if (first.unknown > 0) return result;
  result.no_variance = first.variance <= 0.0;
  if (!(first.mean > 0.0)) return result;

  Totals totals;
  const double gain = std::exp2(exposure_stops);
  for (int y0 = 0; y0 < film.height(); y0 += kStripRows) {
    const int y1 = std::min(y0 + kStripRows, film.height());
    const Strip strip(film, y0, y1);
    for (int y = y0; y < y1; ++y) {
      for (int x = 0; x < film.width(); ++x) {
        const std::size_t i = strip.index(x, y);
        add_pixel(totals, strip.pixel(i), strip.smoothed(i), first, gain);
      }
    }
  }
  const double values = 3.0 * static_cast<double>(result.pixels), sum = totals.relative.sum;
  result.grade = first.least < kSampleFloor ? ErrorGrade::kRough : ErrorGrade::kMeasured;
  result.tail_share = sum > 0.0 ? totals.tails / sum : 0.0;
  result.heavy_tailed = result.tail_share > kTailImage;
  const double widening = result.heavy_tailed ? kTailWidening : 1.0;
  result.rel_mse = mean_square(totals.relative, values, widening);
  result.error = root(result.rel_mse);
  result.rmse = root(mean_square(totals.linear, values, widening));
  result.display_rmse = root(mean_square(totals.display, values, widening));
  result.effective_pixels = totals.squares > 0.0 ? sum * sum / totals.squares : 0.0;
  if (totals.samples_variance > 0.0) {
    result.replicate_ratio = totals.replicates_variance / totals.samples_variance;
  }
  return result;
}

std::vector<std::string> error_notices(const ImageError& error, bool samples_area) {
  std::vector<std::string> notices;
  if (error.unsampled_pixels > 0) notices.emplace_back("unsampled_pixels");
  if (error.grade == ErrorGrade::kUnknown) notices.emplace_back("error_unknown");
  if (error.grade == ErrorGrade::kRough) notices.emplace_back("error_rough");
  if (error.heavy_tailed) notices.emplace_back("heavy_tailed");
  if (error.no_variance) notices.emplace_back("no_variance");
  if (!samples_area) notices.emplace_back("aliasing_not_measured");
  return notices;
}

double unseen_bound(double largest, std::uint64_t samples) {
  return samples == 0 ? largest : largest * std::min(1.0, 3.0 / static_cast<double>(samples));
}

}  // namespace raykiln::render
