#include "raykiln/compare/threshold_test.hpp"

#include <algorithm>
#include <cmath>

namespace raykiln::render {
namespace {

bool finite(const Image& image, std::size_t pixel) {
  return std::isfinite(image.rgb[3 * pixel]) && std::isfinite(image.rgb[3 * pixel + 1]) &&
         std::isfinite(image.rgb[3 * pixel + 2]);
}

double value(const Image& image, std::size_t index) { return static_cast<double>(image.rgb[index]); }

/// Calls use(a, b) for every channel of pixels that are finite in both.
template <class Use>
double for_each_value(const Image& a, const Image& b, const Use& use) {
  double count = 0.0;
  for (std::size_t pixel = 0; 3 * pixel < a.rgb.size(); ++pixel) {
    if (!finite(a, pixel) || !finite(b, pixel)) continue;
    for (std::size_t c = 0; c < 3; ++c) use(value(a, 3 * pixel + c), value(b, 3 * pixel + c));
    count += 3.0;
  }
  return count;
}

}  // namespace

ThresholdVerdict test_thresholds(const Image& render, const Image& reference, const Thresholds& thresholds) {
  ThresholdVerdict verdict;
  const std::size_t pixels = render.rgb.size() / 3;
  for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
    const bool a_finite = finite(render, pixel), b_finite = finite(reference, pixel);
    bool fails = a_finite != b_finite;
    verdict.unlike_not_finite += fails ? 1U : 0U;
    for (std::size_t c = 0; c < 3 && a_finite && b_finite; ++c) {
      const double a = value(render, 3 * pixel + c), b = value(reference, 3 * pixel + c);
      const double apart = std::abs(a - b);
      fails = fails || (apart > thresholds.absolute &&
                        apart > thresholds.relative * std::max(std::abs(a), std::abs(b)));
      if (apart <= verdict.largest) continue;
      verdict.largest = apart;
      verdict.x = static_cast<int>(pixel % static_cast<std::size_t>(render.width));
      verdict.y = static_cast<int>(pixel / static_cast<std::size_t>(render.width));
    }
    verdict.failing_pixels += fails ? 1U : 0U;
  }
  verdict.failing_share =
      pixels > 0 ? static_cast<double>(verdict.failing_pixels) / static_cast<double>(pixels) : 0.0;
  verdict.differs = verdict.unlike_not_finite > 0 || verdict.failing_share > thresholds.failing_share ||
                    verdict.largest > thresholds.hard_limit;
  return verdict;
}

DifferenceFigures difference_figures(const Image& render, const Image& reference) {
  DifferenceFigures figures;
  double absolute = 0.0, squares = 0.0;
  const double count = for_each_value(render, reference, [&](double a, double b) {
    figures.mean_render += a;
    figures.mean_reference += b;
    absolute += std::abs(a - b);
    squares += (a - b) * (a - b);
    figures.largest = std::max(figures.largest, std::abs(a - b));
  });
  if (count <= 0.0) return figures;
  figures.mean_render /= count;
  figures.mean_reference /= count;
  figures.mean_absolute = absolute / count;
  figures.rmse = std::sqrt(squares / count);
  figures.psnr_db = squares > 0.0 ? -20.0 * std::log10(figures.rmse) : 999.0;
  const double floor = 0.01 * figures.mean_reference * figures.mean_reference;
  for_each_value(render, reference, [&](double a, double b) {
    const double below = b * b + floor;
    if (below > 0.0) figures.relmse += (a - b) * (a - b) / below / count;
  });
  return figures;
}

}  // namespace raykiln::render
