#include "raykiln/selftest/mirrors.hpp"

#include <cmath>

#include "raykiln/selftest/small_scene.hpp"

namespace raykiln::render::selftest {
namespace {

Material lobe(double reflectance, double exponent, double emission = 0.0) {
  Material m;
  m.specular = Rgb(static_cast<float>(reflectance));
  m.specular_exp = exponent;
  m.emission = Rgb(static_cast<float>(emission));
  return m;
}

}  // namespace

Outcome mirror_corridor(const Corridor& input, int depth, const LightModel& model,
                        std::uint64_t samples) {
  SmallScene s;
  s.level_square(100.0F, 1.0F, s.material(lobe(input.k_a, 1e12, input.e_a)), false);
  s.level_square(100.0F, 0.0F, s.material(lobe(input.k_b, 1e12, input.e_b)), true);
  s.look({0, 0, 0.5}, {1e-3, 0, 1.5}, {0, 1, 0}, 1e-4);
  RenderSettings settings;
  settings.width = settings.height = 4;
  settings.max_depth = depth;
  settings.light_model = model;
  const Measured m = measure(s.scene(), settings, samples);
  double truth = 0.0, throughput = 1.0;
  for (int k = 0; k <= depth; ++k) {
    truth += throughput * (k % 2 == 0 ? input.e_a : input.e_b);
    throughput *= k % 2 == 0 ? input.k_a : input.k_b;
  }
  return statistically(m, truth, 1e-4);
}

Outcome lobe_in_furnace(double exponent, double angle_rad, double truth, double relative_bias,
                        const LightModel& model, std::uint64_t samples) {
  SmallScene s;
  s.level_square(1000.0F, 0.0F, s.material(lobe(1.0, exponent)));
  s.scene().background = Rgb(1.0F);
  s.look({std::sin(angle_rad), 0, std::cos(angle_rad)}, {0, 0, 0}, {0, 1, 0}, 1e-6);
  RenderSettings settings;
  settings.width = settings.height = 1;
  settings.max_depth = 1;
  settings.light_model = model;
  return statistically(measure(s.scene(), settings, samples), truth, relative_bias);
}

// All pixels have the same weight in the mean of Measured, so the solid angle goes into a sum here.
// Its error comes from independent pictures.
Outcome mirror_image(double exponent, double truth, const LightModel& model,
                     std::uint64_t samples) {
  constexpr int kSide = 64, kPictures = 32;
  const double half = exponent < 1000.0 ? 0.9 : 8.0 / std::sqrt(exponent);  // tangent
  SmallScene s;
  s.level_square(1000.0F, 0.0F, s.material(lobe(1.0, exponent)));
  s.point_light({0, 0, 3}, Rgb(10.0F));
  s.look({0, 0, 2}, {0, 0, 0}, {0, 1, 0}, 2.0 * std::atan(half));
  RenderSettings settings;
  settings.width = settings.height = kSide;
  settings.max_depth = 0;
  settings.light_model = model;
  double mean = 0.0, squares = 0.0, lit = 0.0;
  const double pixel = 2.0 * half / kSide;
  for (int k = 0; k < kPictures; ++k) {
    settings.seed = static_cast<std::uint64_t>(k);
    const Measured m = measure(s.scene(), settings, samples);
    double sum = 0.0;
    for (std::size_t i = 0; i < m.pixels.size(); ++i) {
      const double x = (static_cast<double>(i % kSide) + 0.5) * pixel - half;
      const double y = (static_cast<double>(i / kSide) + 0.5) * pixel - half;
      sum += m.pixels[i] * pixel * pixel * std::pow(1.0 + x * x + y * y, -1.5);
      lit += m.pixels[i] > 0.0 ? 1.0 : 0.0;
    }
    const double delta = sum - mean;
    mean += delta / (k + 1);
    squares += delta * (sum - mean);
  }
  const double error = std::sqrt(squares / (kPictures - 1) / kPictures);
  const bool passed = lit >= 1000.0 && std::abs(mean - truth) <= 4.0 * error + 1e-4 * truth;
  return {passed, text(mean) + " against " + text(truth) + ", " + text((mean - truth) / error) +
                      " sigma of " + text(error)};
}

}  // namespace raykiln::render::selftest
