#include "raykiln/selftest/glass.hpp"

#include <cmath>

#include "raykiln/selftest/small_scene.hpp"

namespace raykiln::render::selftest {
namespace {

/// From the rare side; written out here, apart from the renderer's own function.
double reflectance(double cosine, double n, FresnelFormula formula) {
  if (formula == FresnelFormula::kSchlick) {
    const double r0 = (n - 1.0) * (n - 1.0) / ((n + 1.0) * (n + 1.0));
    return r0 + (1.0 - r0) * std::pow(1.0 - cosine, 5.0);
  }
  const double t = std::sqrt(n * n - 1.0 + cosine * cosine);
  const double rs = (cosine - t) / (cosine + t);
  const double rp = (n * n * cosine - t) / (n * n * cosine + t);
  return 0.5 * (rs * rs + rp * rp);
}

RenderSettings pixels(int side, const LightModel& model, int depth) {
  RenderSettings settings;
  settings.width = settings.height = side;
  settings.light_model = model;
  settings.max_depth = depth;
  return settings;
}

}  // namespace

double slab_transmittance(double f, int round_trips) {
  if (round_trips < 0) return (1.0 - f) / (1.0 + f);
  return (1.0 - f) * (1.0 - f) * (1.0 - std::pow(f, 2.0 * round_trips + 2.0)) / (1.0 - f * f);
}

Outcome slab(double index, double angle_rad, int round_trips, const LightModel& model,
             std::uint64_t samples) {
  SmallScene s;
  const auto glass = s.material(clear_glass(static_cast<float>(index)));
  s.level_square(4000.0F, 0.0F, glass, true);
  s.level_square(4000.0F, -1.0F, glass, false);
  s.level_square(9000.0F, -2.0F, s.material(matte(0.0F, 1.0F)));
  s.look({-20.0 * std::sin(angle_rad), 0, 20.0 * std::cos(angle_rad)}, {0, 0, 0}, {0, 1, 0}, 1e-4);
  RenderSettings settings = pixels(1, model, round_trips < 0 ? 128 : 2 + 2 * round_trips);
  settings.emitter_sampling = false;  // a shadow ray would count for one more reflection
  const double f = reflectance(std::cos(angle_rad), index, model.fresnel);
  return statistically(measure(s.scene(), settings, samples), slab_transmittance(f, round_trips), 1e-5);
}

Outcome window_from_below(double index, const LightModel& model, int side) {
  SmallScene s;
  s.level_square(1000.0F, 0.0F, s.material(clear_glass(static_cast<float>(index))));
  s.level_square(1000.0F, -2.0F, s.material(matte(0.0F)));
  s.scene().background = Rgb(1.0F);
  const double truth = std::tan(std::asin(1.0 / index)), half = 1.3 * truth;
  s.look({0, 0, -1}, {0, 0, 0}, {0, 1, 0}, 2.0 * std::atan(half));
  RenderSettings settings = pixels(side, model, 1);
  settings.pixel_mode = PixelMode::kCentre;
  const Measured m = measure(s.scene(), settings, 64);
  // Radius of each lit pixel: none beyond the disc by more than a pixel, none dark within it. Near
  // the edge little is let through; 64 samples of a pixel 1.5 pixels inside do not all miss.
  const double pixel = 2.0 * half / side;
  const auto pixels_across = static_cast<std::size_t>(side);
  int wrong = 0, lit = 0;
  for (std::size_t i = 0; i < m.pixels.size(); ++i) {
    const double x = (static_cast<double>(i % pixels_across) + 0.5) * pixel - half;
    const double y = (static_cast<double>(i / pixels_across) + 0.5) * pixel - half;
    const double beyond = (std::hypot(x, y) - truth) / pixel;
    const bool bright = m.pixels[i] > 0.0;
    lit += bright ? 1 : 0;
    if ((bright && beyond > 1.0) || (!bright && beyond < -1.0)) ++wrong;
  }
  const double radius = std::sqrt(lit * pixel * pixel / 3.14159265358979323846);
  return {wrong == 0 && std::abs(radius - truth) <= pixel && m.stats.non_finite == 0,
          "radius " + text(radius) + " h against " + text(truth) + ", pixel " + text(pixel) +
              ", wrong pixels " + text(wrong)};
}

double average_reflectance(double index, FresnelFormula formula) {
  constexpr int kSteps = 200000;
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double c = (i + 0.5) / kSteps;
    sum += 2.0 * c * reflectance(c, index, formula) / kSteps;
  }
  return sum;
}

// The patch is white, faces the border and lies so near that the border fills its half space; it
// collects pi times the flux share. The emitter is black, so nothing comes back.
Outcome flux_out_of_glass(double index, const LightModel& model, std::uint64_t samples) {
  SmallScene s;
  s.level_square(1e4F, 0.0F, s.material(clear_glass(static_cast<float>(index))));
  s.level_square(1e5F, -1.0F, s.material(matte(0.0F, 1.0F)));
  s.level_square(0.02F, 0.02F, s.material(matte(1.0F)), false);
  s.look({0, 0, 0.01}, {0, 0, 0.02}, {0, 1, 0}, 0.1);
  const double f = average_reflectance(index, model.fresnel);
  const double truth = (1.0 - f) / (model.radiance_scaling ? index * index : 1.0);
  // Two reflections: at the patch and at the border. Light that the border sends back to the patch
  // is not part of the first encounter.
  return statistically(measure(s.scene(), pixels(16, model, 2), samples), truth, 1e-4);
}

Outcome radiance_across_border(double index, bool camera_inside, const LightModel& model,
                               std::uint64_t samples) {
  SmallScene s;
  s.level_square(1000.0F, 0.0F, s.material(clear_glass(static_cast<float>(index))));
  const double side = camera_inside ? -1.0 : 1.0;
  s.level_square(1000.0F, static_cast<float>(-2.0 * side), s.material(matte(0.0F, 1.0F)));
  s.look({0, 0, side}, {0, 0, 0}, {0, 1, 0}, 1e-4);
  const double f = reflectance(1.0, index, model.fresnel), n2 = index * index;
  const double scale = !model.radiance_scaling ? 1.0 : camera_inside ? n2 : 1.0 / n2;
  return statistically(measure(s.scene(), pixels(4, model, 1), samples), (1.0 - f) * scale, 1e-5);
}

}  // namespace raykiln::render::selftest
