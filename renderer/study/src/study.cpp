#include "raykiln/study/study.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>

#include "half_pictures.hpp"
#include "raykiln/accuracy/true_error.hpp"

namespace raykiln::render {
namespace {

/// One-sided 95 % of the standard normal distribution.
constexpr double kOneSided95 = 1.6448536269514722;
/// Seeds of a reference lie this far from those of the variants.
constexpr std::uint64_t kOtherSeeds = 0x5EED0000;

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// A variant's curve before there is a truth to hold it against.
struct Rendered {
  VariantCurve curve;
  std::vector<std::vector<float>> pictures;  ///< one a point: a float is exact to 6e-8 of a channel
  std::array<std::vector<double>, 2> halves;
};

std::shared_ptr<const PreparedScene> prepared(const std::shared_ptr<const Scene>& scene,
                                              const BuildParams& params, TaskRunner& runner) {
  return prepare(scene, build_scene_tree(*scene, params, runner));
}

Rendered render_variant(const std::shared_ptr<const Scene>& scene, const Variant& variant, double seconds,
                        TaskRunner& runner) {
  Rendered result;
  result.curve.variant = variant;
  const auto begun = std::chrono::steady_clock::now();
  const auto ready = prepared(scene, variant.tree, runner);
  result.curve.build_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  HalfPictures halves(ready, variant.settings, {variant.settings.seed, variant.settings.seed + 1});
  // The next pass would take as long as all before it.
  do {
    halves.advance(runner);
    const auto whole = halves.whole();
    result.pictures.emplace_back(whole.begin(), whole.end());
    result.curve.points.push_back({.samples = halves.samples(), .seconds = halves.seconds()});
  } while (2.0 * halves.seconds() <= 1.5 * seconds);
  result.halves = {halves.half(0), halves.half(1)};
  return result;
}

/// What a truth r divides squares by: r^2 + 0.01 M^2.
std::vector<double> scales(const std::vector<double>& truth) {
  const double mean = mean_of(truth);
  std::vector<double> result(truth.size());
  std::transform(truth.begin(), truth.end(), result.begin(),
                 [mean](double r) { return r * r + 0.01 * mean * mean; });
  return result;
}

/// Mean and standard error of values of which three in a row belong to one pixel.
struct Estimate {
  double mean = 0.0, error = 0.0;
};
Estimate over_pixels(const std::vector<double>& values) {
  const std::size_t pixels = values.size() / 3;
  double sum = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < pixels; ++i) {
    const double pixel = (values[3 * i] + values[3 * i + 1] + values[3 * i + 2]) / 3.0;
    sum += pixel;
    squares += pixel * pixel;
  }
  const auto n = static_cast<double>(pixels);
  const double mean = sum / n, variance = std::max(0.0, squares / n - mean * mean);
  return {mean, std::sqrt(variance / std::max(n - 1.0, 1.0))};
}

/// (a - r1)(b - r2) over the scale: the noise of four independent renders has mean 0 in it.
Bias bias_of(const std::array<std::vector<double>, 2>& x, const std::array<std::vector<double>, 2>& r,
             const std::vector<double>& scale, double mean) {
  std::vector<double> products(scale.size()), differences(scale.size()), noise(scale.size());
  for (std::size_t i = 0; i < scale.size(); ++i) {
    const double first = x[0][i] - r[0][i], second = x[1][i] - r[1][i];
    products[i] = first * second / scale[i];
    differences[i] = 0.5 * (first + second) / mean;
    noise[i] = 0.5 * (first - second) / mean;  // the same scatter without what both halves share
  }
  const Estimate square = over_pixels(products), bright = over_pixels(differences);
  return {.value = std::sqrt(std::max(0.0, square.mean)),
          // A square below 0 is noise: the bound is never less than what could be seen at all.
          .at_most = std::sqrt(std::max(0.0, square.mean) + kOneSided95 * square.error),
          .certain = square.mean > 3.0 * square.error,
          .brightness = bright.mean,
          .brightness_error = over_pixels(noise).error};
}

/// The reference's own error: half the difference of its halves is the noise of their mean.
double own_error(const std::array<std::vector<double>, 2>& r, const std::vector<double>& scale) {
  double sum = 0.0;
  for (std::size_t i = 0; i < scale.size(); ++i) {
    const double half = 0.5 * (r[0][i] - r[1][i]);
    sum += half * half / scale[i];
  }
  return std::sqrt(sum / static_cast<double>(scale.size()));
}

/// Fills in the errors of all points; the smallest.
double judge(std::vector<Rendered>& rendered, const std::vector<double>& truth) {
  double smallest = std::numeric_limits<double>::infinity();
  for (Rendered& one : rendered) {
    for (std::size_t i = 0; i < one.pictures.size(); ++i) {
      const std::vector<double> picture(one.pictures[i].begin(), one.pictures[i].end());
      const TrueError found = true_error(picture, truth);
      one.curve.points[i].error = found.error;
      one.curve.points[i].display_rmse = found.display_rmse;
      if (found.error > 0.0) smallest = std::min(smallest, found.error);
    }
  }
  return std::isfinite(smallest) ? smallest : 0.0;
}

/// Between two points of a curve in the log-log plot: y at x.
double between(double x, double x0, double x1, double y0, double y1) {
  if (!(x0 > 0.0 && x1 > 0.0 && y0 > 0.0 && y1 > 0.0) || x0 == x1) return y1;
  return std::exp(std::log(y0) + std::log(x / x0) / std::log(x1 / x0) * std::log(y1 / y0));
}

}  // namespace

Study measure_knobs(std::shared_ptr<const Scene> scene, const std::vector<Variant>& variants,
                    const StudyBudget& budget, TaskRunner& runner, const StudyProgress& progress) {
  std::vector<Rendered> rendered;
  const auto count = static_cast<double>(variants.size());
  for (const Variant& variant : variants) {
    progress(variant.name, static_cast<double>(rendered.size()) / count);
    rendered.push_back(render_variant(scene, variant, budget.seconds, runner));
  }

  Study study;
  const RenderSettings& settings = variants.front().settings;
  HalfPictures reference(prepared(scene, variants.front().tree, runner), settings,
                         {settings.seed + kOtherSeeds, settings.seed + kOtherSeeds + 1});
  std::array<std::vector<double>, 2> halves;
  std::vector<double> scale, truth;
  StudyReference& r = study.reference;
  do {
    progress("reference", std::min(0.99, reference.seconds() / budget.reference_seconds));
    reference.advance(runner);
    truth = reference.whole();
    halves = {reference.half(0), reference.half(1)};
    r.samples = reference.samples();
    r.seconds = reference.seconds();
    if (!(mean_of(truth) > 0.0)) continue;
    r.black = false;
    scale = scales(truth);
    r.error = own_error(halves, scale);
    r.smallest_error = judge(rendered, truth);
  } while (!(r.samples >= 16 && r.exact_enough()) && 2.0 * r.seconds <= budget.reference_seconds);
  for (Rendered& one : rendered) {
    if (!scale.empty()) one.curve.bias = bias_of(one.halves, halves, scale, mean_of(truth));
    study.curves.push_back(std::move(one.curve));
  }
  return study;
}

double error_at(const std::vector<StudyPoint>& points, double seconds) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].seconds < seconds) continue;
    if (i == 0) return points[0].seconds == seconds ? points[0].error : -1.0;
    return between(seconds, points[i - 1].seconds, points[i].seconds, points[i - 1].error, points[i].error);
  }
  return -1.0;
}

double seconds_to(const std::vector<StudyPoint>& points, double error) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].error > error) continue;
    if (i == 0 || points[i].error == error) return points[i].seconds;
    return between(error, points[i - 1].error, points[i].error, points[i - 1].seconds, points[i].seconds);
  }
  return -1.0;
}

}  // namespace raykiln::render
