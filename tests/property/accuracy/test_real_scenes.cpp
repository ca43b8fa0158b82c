// Intervals of rendered pictures against the truth: over many seeds of small scenes. The truth of a
// picture is the mean of all the others (Celarek et al. 2019 estimate errors from many short runs in
// this way), independent of it and with an error 14 (8) times as small.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <string_view>

#include "raykiln/accuracy/image_error.hpp"
#include "raykiln/accuracy/pixel_error.hpp"
#include "raykiln/accuracy/quantiles.hpp"
#include "raykiln/accuracy/true_error.hpp"
#include "support/scene_pieces.hpp"

namespace raykiln::render {
namespace {

using support::SceneBuilder;

bool long_run() {
  const char* value = std::getenv("RAYKILN_LONG");
  return value != nullptr && std::string_view(value) == "1";
}

/// A room with the camera in one wall and a lamp in the ceiling.
SceneBuilder room(const Rgb& lamp_light) {
  SceneBuilder b;
  const auto white = b.material(support::diffuse_material(Rgb(0.6F)));
  b.box({-1, -1, -1}, {1, 1, 1}, white, true);
  if (lamp_light.x > 0.0F) {
    const auto lamp = b.material(support::diffuse_material(Rgb(0.0F), lamp_light));
    b.quad({Vec3f(-0.3F, 0.99F, -0.3F), {0.3F, 0.99F, -0.3F}, {0.3F, 0.99F, 0.3F}, {-0.3F, 0.99F, 0.3F}}, lamp);
  }
  b.camera({0.0F, 0.0F, 0.95F}, {0.0F, -0.3F, -1.0F}, {0, 1, 0}, 1.1F);
  return b;
}

SceneBuilder diffuse_with_area_light() {
  SceneBuilder b = room({6.0F, 5.0F, 4.0F});
  b.box({-0.6F, -0.99F, -0.6F}, {-0.1F, -0.2F, -0.1F}, b.material(support::diffuse_material({0.7F, 0.2F, 0.1F})));
  return b;
}

SceneBuilder glass_with_caustic() {
  SceneBuilder b = room({6.0F, 5.0F, 4.0F});
  b.box({-0.3F, -0.9F, -0.5F}, {0.3F, -0.3F, 0.1F}, b.material(support::glass_material(1.5F, 1e10)));
  return b;
}

SceneBuilder many_small_lights() {
  SceneBuilder b = room(Rgb(0.0F));
  const auto lamp = b.material(support::diffuse_material(Rgb(0.0F), {200.0F, 150.0F, 100.0F}));
  for (int i = 0; i < 36; ++i) {
    const float x = -0.8F + 0.3F * static_cast<float>(i % 6), z = -0.8F + 0.3F * static_cast<float>(i / 6);
    b.quad({Vec3f(x, 0.98F, z), {x + 0.02F, 0.98F, z}, {x + 0.02F, 0.98F, z + 0.02F}, {x, 0.98F, z + 0.02F}}, lamp);
    b.point_light({z, 0.3F, x}, Rgb(0.01F));
  }
  return b;
}

struct Case {
  const char* name;
  SceneBuilder (*scene)();
};

class RealScenes : public ::testing::TestWithParam<Case> {};

TEST_P(RealScenes, IntervalsHoldTheTruthOrAreFlagged) {
  const std::size_t seeds = long_run() ? 200 : 64;
  RenderSettings settings;
  settings.width = settings.height = long_run() ? 24 : 12;
  constexpr std::uint64_t kSamples = 64;
  const auto scene = GetParam().scene().prepare();
  std::vector<PixelErrors> pictures;
  std::vector<ImageError> shown;
  std::vector<double> sum;
  for (std::uint64_t seed = 0; seed < seeds; ++seed) {
    settings.seed = 500 + seed;
    Film film(settings.width, settings.height);
    merge(film, support::render_all(*scene, settings, kSamples));
    pictures.push_back(pixel_errors(film));
    shown.push_back(image_error(film));
    sum.resize(pictures.back().mean.size());
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += pictures.back().mean[i];
  }
  const double t = student_t95(kSamples - 1.0), others = static_cast<double>(seeds - 1);
  double covered = 0, flagged = 0, inside = 0, all = 0, ratio = 0;
  std::vector<double> truth(sum.size());
  for (std::size_t s = 0; s < seeds; ++s) {
    for (std::size_t i = 0; i < sum.size(); ++i) truth[i] = (sum[i] - pictures[s].mean[i]) / others;
    const TrueError real = true_error(pictures[s].mean, truth);
    covered += shown[s].error.low <= real.error && real.error <= shown[s].error.high ? 1 : 0;
    flagged += shown[s].heavy_tailed ? 1 : 0;
    ratio += real.rel_mse / shown[s].rel_mse.value / static_cast<double>(seeds);
    for (std::size_t i = 0; i < sum.size(); ++i) {
      const double distance = std::abs(pictures[s].mean[i] - truth[i]);
      if (distance <= 1e-9 * truth[i]) continue;  // a lamp seen directly: no noise, nothing to cover
      inside += distance <= t * pictures[s].standard_error[i] ? 1 : 0;
      ++all;
    }
  }
  const double n = static_cast<double>(seeds);
  RecordProperty("covered", std::to_string(covered / n));
  RecordProperty("pixels", std::to_string(inside / all));
  RecordProperty("flagged", std::to_string(flagged / n));
  RecordProperty("ratio", std::to_string(ratio));
  std::printf("%s: image %.3f of %zu, pixels %.4f of %.0f, flagged %.3f, true/shown relMSE %.3f\n",
              GetParam().name, covered / n, seeds, inside / all, all, flagged / n, ratio);
  // What is shown is of the size of the truth, and a flagged picture's interval, wider, holds it too.
  EXPECT_GT(ratio, 0.8);
  EXPECT_LT(ratio, 2.5);
  // 180 of 200 are what is asked for; with fewer seeds the band is 4 standard deviations about 0.95.
  EXPECT_GE(covered / n, long_run() ? 0.90 : 0.95 - 4.0 * std::sqrt(0.05 * 0.95 / n));
  // Single pixels of a flagged picture promise nothing.
  if (flagged / n >= 0.95) return;
  EXPECT_GE(inside / all, 0.93);
  EXPECT_LE(inside / all, 0.97);
}

INSTANTIATE_TEST_SUITE_P(Scenes, RealScenes,
                         ::testing::Values(Case{"diffuse_with_area_light", diffuse_with_area_light},
                                           Case{"glass_with_caustic", glass_with_caustic},
                                           Case{"many_small_lights", many_small_lights}),
                         [](const auto& tested) { return std::string(tested.param.name); });

}  // namespace
}  // namespace raykiln::render
