#include "raykiln/accuracy/image_error.hpp"

#include <algorithm>
#include <cmath>

#include "figures.hpp"

namespace raykiln::render {
namespace {

/// Pixels a side that are worked on at once: what they need stays near the processor.
constexpr int kRegionSide = 64;

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
  Survey survey;
  for (std::size_t i = 0; i < result.pixels; ++i) survey.add(pixel_statistics(film, i));
  if (!note_survey(result, survey)) return result;

  Totals totals;
  const double gain = std::exp2(exposure_stops);
  for (int y = 0; y < film.height(); y += kRegionSide) {
    for (int x = 0; x < film.width(); x += kRegionSide) {
      const PixelRect core{x, y, std::min(x + kRegionSide, film.width()), std::min(y + kRegionSide, film.height())};
      add_region(totals, film, core, kRegionMargin, survey, gain);
    }
  }
  const double values = 3.0 * static_cast<double>(result.pixels);
  const auto square = [&](const Tally& t) { return t.sum > 0.0 ? Square{t.sum / values, t.variance / (t.sum * t.sum)} : Square{}; };
  set_figures(result, {square(totals.relative), square(totals.linear), square(totals.display)},
              totals.relative.sum > 0.0 ? totals.tails / totals.relative.sum : 0.0);
  return result;
}

std::vector<std::string> error_notices(const ImageError& error, bool samples_area) {
  std::vector<std::string> notices;
  if (error.unsampled_pixels > 0) notices.emplace_back("unsampled_pixels");
  if (error.grade == ErrorGrade::kUnknown) notices.emplace_back("error_unknown");
  if (error.grade == ErrorGrade::kRough) notices.emplace_back("error_rough");
  if (error.sampled) notices.emplace_back("error_sampled");
  if (error.heavy_tailed) notices.emplace_back("heavy_tailed");
  if (error.no_variance) notices.emplace_back("no_variance");
  if (!samples_area) notices.emplace_back("aliasing_not_measured");
  return notices;
}

double unseen_bound(double largest, std::uint64_t samples) {
  return samples == 0 ? largest : largest * std::min(1.0, 3.0 / static_cast<double>(samples));
}

}  // namespace raykiln::render
