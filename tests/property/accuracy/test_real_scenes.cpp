// Intervals of rendered pictures against the truth: over many seeds of small scenes. The truth of a
// picture is the mean of all the others (Celarek et al. 2019 estimate errors from many short runs in
// this way), independent of it and with an error 14 (8) times as small.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string_view>

#include "raykiln/accuracy/allocation.hpp"
#include "raykiln/accuracy/image_error.hpp"
#include "raykiln/accuracy/pixel_error.hpp"
#include "raykiln/accuracy/quantiles.hpp"
#include "raykiln/accuracy/true_error.hpp"
#include "support/sanitized.hpp"
#include "support/small_rooms.hpp"

namespace raykiln::render {
namespace {

using support::SceneBuilder;

bool long_run() {
  const char* value = std::getenv("RAYKILN_LONG");
  return value != nullptr && std::string_view(value) == "1";
}

struct Case {
  const char* name;
  SceneBuilder (*scene)();
  std::uint64_t samples;
  bool tame;  ///< enough samples for what happens in this scene: not flagged
  Sampler sampler = Sampler::kRandom;
  bool adaptive = false;
  bool ordinary = true;  ///< cheap enough, and worth it, for the ordinary run
};

/// `samples` everywhere, or on average as an adaptive job places them: 64 first, then steps of a quarter.
Film rendered(const PreparedScene& scene, const RenderSettings& settings, std::uint64_t samples, bool adaptive) {
  Film film = make_film(settings);
  const std::uint64_t first = adaptive ? kSampleFloor : samples;
  merge(film, support::render_all(scene, settings, first));
  for (double mean = 1.25 * static_cast<double>(first); adaptive && mean < 1.2 * static_cast<double>(samples); mean *= 1.25) {
    const auto there = cell_samples(film), wanted = allocate_samples(film, mean, 1U << 20U);
    std::size_t cell = 0;
    for (int y = 0; y < settings.height; y += kCellSide) {
      for (int x = 0; x < settings.width; x += kCellSide, ++cell) {
        std::vector<SampleBlock> blocks;
        for (const SampleBlock& b : blocks_for(wanted[cell])) {
          if (b.complete && b.first >= there[cell]) blocks.push_back(b);
        }
        if (blocks.empty()) continue;
        const PixelRect rect{x, y, std::min(x + kCellSide, settings.width), std::min(y + kCellSide, settings.height)};
        merge(film, render_tile(scene, settings, rect, blocks, {}));
      }
    }
  }
  return film;
}

/// Of scenes whose rate has an upper bound, too: with 200 a rate of 0.96, conservative as it may be, is beyond 0.98 in
/// 4 of 100 cases, with so many in 5 of 10^4.
constexpr std::size_t kManySeeds = 800;

class RealScenes : public ::testing::TestWithParam<Case> {};

TEST_P(RealScenes, IntervalsHoldTheTruthOrAreFlagged) {
  if (!GetParam().ordinary && !long_run()) GTEST_SKIP() << "RAYKILN_LONG=1";
  const std::size_t seeds = tests::kSanitized ? 4 : !long_run() ? 64 : GetParam().tame ? kManySeeds : 200;
  RenderSettings settings;
  settings.width = settings.height = long_run() ? 24 : 12;
  if (GetParam().adaptive) settings.width = kCellSide + settings.height / 3;  // at least two cells
  settings.sampler = GetParam().sampler;
  const std::uint64_t samples = GetParam().samples;
  const auto scene = GetParam().scene().prepare();
  std::vector<PixelErrors> pictures;
  std::vector<ImageError> shown;
  std::vector<double> sum;
  for (std::uint64_t seed = 0; seed < seeds; ++seed) {
    settings.seed = 500 + seed;
    const Film film = rendered(*scene, settings, samples, GetParam().adaptive);
    pictures.push_back(pixel_errors(film));
    shown.push_back(image_error(film));
    sum.resize(pictures.back().mean.size());
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += pictures.back().mean[i];
  }
  const double t = student_t95(static_cast<double>(samples) - 1.0), others = static_cast<double>(seeds - 1);
  double covered = 0, flagged = 0, inside = 0, all = 0, ratio = 0, width = 0;
  std::vector<double> truth(sum.size());
  for (std::size_t s = 0; s < seeds; ++s) {
    for (std::size_t i = 0; i < sum.size(); ++i) truth[i] = (sum[i] - pictures[s].mean[i]) / others;
    const TrueError real = true_error(pictures[s].mean, truth);
    covered += shown[s].error.low <= real.error && real.error <= shown[s].error.high ? 1 : 0;
    flagged += shown[s].heavy_tailed ? 1 : 0;
    width += std::log(shown[s].error.high / shown[s].error.low) / static_cast<double>(seeds);
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
  RecordProperty("width", std::to_string(std::exp(width)));
  std::printf("%s: image %.3f of %zu, pixels %.4f of %.0f, flagged %.3f, true/shown relMSE %.3f, high/low %.3f\n",
              GetParam().name, covered / n, seeds, inside / all, all, flagged / n, ratio, std::exp(width));
  if (tests::kSanitized) return;  // 4 seeds say nothing of rates
  // What is shown is the truth on average, up to what few samples can tell.
  EXPECT_GT(ratio, GetParam().tame ? 0.95 : 0.8);
  EXPECT_LT(ratio, GetParam().tame ? 1.05 : 1.25);
  // 180 to 196 of 200 are asked for, as a rate; with fewer seeds the band is 4 standard deviations about 0.95.
  const double band = 4.0 * std::sqrt(0.05 * 0.95 / n);
  EXPECT_GE(covered / n, long_run() ? 0.90 : 0.95 - band);
  // An interval of everything holds the truth, too: a quarter wide, flagged a factor of 2 to 2.5.
  EXPECT_LE(std::exp(width), GetParam().tame ? 1.5 : 3.0);
  if (!GetParam().tame) {
    EXPECT_GE(flagged / n, 0.95);
    return;  // wider intervals; single pixels, whose are not, promise nothing
  }
  EXPECT_LE(covered / n, long_run() ? 0.98 : 1.0);
  EXPECT_LE(flagged / n, 0.05);
  EXPECT_GE(inside / all, 0.93);
  EXPECT_LE(inside / all, 0.97);
}

INSTANTIATE_TEST_SUITE_P(Scenes, RealScenes,
                         ::testing::Values(Case{"diffuse_with_area_light", support::diffuse_with_area_light, 64, true},
                                           Case{"diffuse_by_sobol", support::diffuse_with_area_light, 128, true, Sampler::kSobol},
                                           Case{"diffuse_adaptive", support::diffuse_with_area_light, 96, true, Sampler::kRandom, true},
                                           Case{"diffuse_adaptive_by_sobol", support::diffuse_with_area_light, 256, true, Sampler::kSobol, true, false},
                                           Case{"slit_by_sobol", support::lamp_over_a_slit, 128, false, Sampler::kSobol, false, false},
                                           Case{"caustic_by_sobol", support::glass_with_caustic, 128, false, Sampler::kSobol, false, false},
                                           Case{"caustic_adaptive", support::glass_with_caustic, 128, false, Sampler::kRandom, true, false},
                                           Case{"lamp_over_a_slit", support::lamp_over_a_slit, 64, false},
                                           Case{"glass_with_caustic", support::glass_with_caustic, 64, false},
                                           Case{"many_small_lights", support::many_small_lights, 64, false}),
                         [](const auto& tested) { return std::string(tested.param.name); });

}  // namespace
}  // namespace raykiln::render
