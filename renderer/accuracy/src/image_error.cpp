#include "raykiln/accuracy/image_error.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "raykiln/accuracy/quantiles.hpp"
#include "raykiln/image/display.hpp"
#include "smoothed_means.hpp"
#include "tally.hpp"

namespace raykiln::render {
namespace {

constexpr int kWindowRadius = 2;
/// Rows above and below a strip: squared errors of the windows' pixels need windows of their own.
constexpr int kMargin = 2 * kWindowRadius;
constexpr int kStripRows = 16;       ///< rows that are worked on at once
constexpr double kFewEvents = 15.0;  ///< samples that make up the variance of 3 x 3 pixels: too few below
constexpr double kTailImage = 0.4;   ///< part of rel_mse in such pixels that raises the flag
constexpr double kTailWidening = 3.0;
constexpr std::array<double, 3> kLuminance{0.2126, 0.7152, 0.0722};

/// What is added up over the whole picture.
struct Totals {
  Tally relative, linear, display;
  double tails = 0.0;  ///< relative squares in pixels about which too few samples speak
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
    const PixelStatistics p = pixel_statistics(film, i);
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

/// Rows [y0, y1) of the film with as many more around as windows reach.
struct Strip {
  std::vector<PixelStatistics> pixels;
  int width, rows;
  std::size_t begin, end;  ///< the pixels of [y0, y1)

  Strip(const Film& film, int y0, int y1) : width(film.width()) {
    const int first = std::max(0, y0 - kMargin), last = std::min(film.height(), y1 + kMargin);
    rows = last - first;
    begin = index(y0 - first);
    end = index(y1 - first);
    for (std::size_t i = index(first); i < index(last); ++i) {
      pixels.push_back(pixel_statistics(film, i));
    }
  }
  [[nodiscard]] std::size_t index(int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width);
  }
  [[nodiscard]] Windows windows(int radius) const { return {width, rows, radius}; }
};

/// relative[i] summed over the pixels whose 3 x 3 window owes its error to few samples. m samples of
/// equal weight in a window give (sum a)^2 / sum (a largest_share)^2 = m if each is in another pixel.
double in_tails(const Strip& strip, const SquaredErrors& relative) {
  std::vector<double> sums(relative.size()), squares(relative.size());
  for (std::size_t i = 0; i < relative.size(); ++i) {
    sums[i] = relative[i].total();
    const double of_one = sums[i] * strip.pixels[i].largest_share;
    squares[i] = of_one * of_one;
  }
  const Windows windows = strip.windows(1);
  const auto all = windows.sums(sums), ones = windows.sums(squares);
  double result = 0.0;
  for (std::size_t i = strip.begin; i < strip.end; ++i) {
    const bool few = all[i] * all[i] < kFewEvents * ones[i];
    if (few && strip.pixels[i].samples >= kSampleFloor) result += sums[i];
  }
  return result;
}

void add_strip(Totals& totals, const Strip& strip, const Survey& survey, double gain) {
  const Windows windows = strip.windows(kWindowRadius);
  const auto means = smoothed_means(strip.pixels, windows);
  SquaredErrors errors(strip.pixels.size());
  const auto tally = [&](Tally& into, auto set_error) {
    for (std::size_t i = 0; i < errors.size(); ++i) {
      errors[i] = {};
      for (std::size_t c = 0; c < 3; ++c) {
        const double variance = strip.pixels[i].variance[c];
        if (variance > 0.0) set_error(errors[i], c, means[c][i], variance);
      }
    }
    add(into, errors, strip.pixels, windows, survey.correlation, strip.begin, strip.end);
  };
  tally(totals.linear, [](SquaredError& e, std::size_t c, double, double variance) { set(e, c, variance); });
  tally(totals.display, [gain](SquaredError& e, std::size_t c, double mean, double variance) {
    set_display(e, c, mean, std::sqrt(variance), gain);
  });
  const double floor = 0.01 * survey.mean * survey.mean;
  tally(totals.relative, [floor](SquaredError& e, std::size_t c, double mean, double variance) {
    set(e, c, variance / (mean * mean + floor));
  });
  totals.tails += in_tails(strip, errors);  // the relative ones
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
    add_strip(totals, Strip(film, y0, std::min(y0 + kStripRows, film.height())), first, gain);
  }
  const double values = 3.0 * static_cast<double>(result.pixels);
  result.grade = first.least < kSampleFloor ? ErrorGrade::kRough : ErrorGrade::kMeasured;
  result.heavy_tailed = totals.tails > kTailImage * totals.relative.sum;
  const double widening = result.heavy_tailed ? kTailWidening : 1.0;
  result.rel_mse = mean_square(totals.relative, values, widening);
  result.error = root(result.rel_mse);
  result.rmse = root(mean_square(totals.linear, values, widening));
  result.display_rmse = root(mean_square(totals.display, values, widening));
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
