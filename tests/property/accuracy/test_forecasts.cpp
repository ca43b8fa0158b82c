// Forecasts and error targets over rendered rooms, as jobs make and keep them. Time is counted in
// samples: a sample takes the same time throughout, so what is judged is the error alone.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "raykiln/accuracy/image_error.hpp"
#include "raykiln/accuracy/pixel_error.hpp"
#include "raykiln/accuracy/true_error.hpp"
#include "raykiln/jobs/forecast.hpp"
#include "support/sanitized.hpp"
#include "support/small_rooms.hpp"

namespace raykiln::render {
namespace {

using server::CurvePoint;
using server::Forecast;
using support::SceneBuilder;

bool long_run() {
  const char* value = std::getenv("RAYKILN_LONG");
  return value != nullptr && std::string_view(value) == "1";
}

/// A picture that goes on block by block.
class Progress {
 public:
  Progress(const PreparedScene& scene, const RenderSettings& settings)
      : scene_(scene), settings_(settings), film_(make_film(settings)) {}

  /// To the first border of a block with at least so many samples.
  void advance_to(std::uint64_t samples) {
    std::vector<SampleBlock> blocks;
    for (; samples_ < samples; ++block_) {
      blocks.push_back(sample_block(block_));
      samples_ = blocks.back().first + blocks.back().count;
    }
    merge(film_, render_tile(scene_, settings_, {0, 0, settings_.width, settings_.height}, blocks, {}));
  }
  [[nodiscard]] std::uint64_t samples() const { return samples_; }
  [[nodiscard]] ImageError error() const { return image_error(film_); }
  [[nodiscard]] std::vector<double> picture() const { return pixel_errors(film_).mean; }

 private:
  const PreparedScene& scene_;
  RenderSettings settings_;
  Film film_;
  std::uint64_t samples_ = 0, block_ = 0;
};

/// What a job knows of it.
server::PictureError as_judged(const ImageError& e) {
  server::PictureError error;
  error.grade = name(e.grade);
  error.error = {e.error.value, e.error.low, e.error.high};
  error.heavy_tailed = e.heavy_tailed;
  error.least_samples = e.least_samples;
  return error;
}

RenderSettings square(int side, std::uint64_t seed) {
  RenderSettings settings;
  settings.width = settings.height = side;
  settings.seed = seed;
  return settings;
}

constexpr std::uint64_t kMostSamples = 4096;  ///< within which a target has to be met

struct Room {
  const char* name;
  SceneBuilder (*scene)();
  double target;  ///< error at which a job stops after some hundred samples; 0: flagged long after
  bool ordinary;  ///< cheap enough for the ordinary run
};

class Rooms : public ::testing::TestWithParam<Room> {};

TEST_P(Rooms, ForecastsHold) {
  if (!GetParam().ordinary && !long_run()) GTEST_SKIP() << "RAYKILN_LONG=1";
  const int seeds = tests::kSanitized ? 2 : long_run() ? 12 : 6;
  const std::uint64_t end = long_run() ? 1088 : 576;
  const auto scene = GetParam().scene().prepare();
  double hits = 0, scored = 0, wide = 0, late = 0, tails = 0;
  for (int seed = 0; seed < seeds; ++seed) {
    Progress job(*scene, square(16, 900 + static_cast<std::uint64_t>(seed)));
    std::vector<CurvePoint> curve;
    std::vector<Forecast> forecasts;
    while (job.samples() < end) {
      job.advance_to(std::max<std::uint64_t>(2, job.samples() + (job.samples() + 9) / 10));
      const ImageError e = job.error();
      CurvePoint point;
      point.render_seconds = point.samples = static_cast<double>(job.samples());
      point.error = as_judged(e).error;
      server::add_point(curve, point);
      const std::size_t before = forecasts.size();
      const auto basis = server::basis_of(as_judged(e));
      for (const Forecast& f : server::update_forecasts(forecasts, curve, basis)) {
        scored += 1;
        hits += f.hit() ? 1 : 0;
      }
      if (forecasts.size() == before || job.samples() < kSampleFloor) continue;
      const server::TimeRange& range = forecasts.back().seconds;
      late += 1;
      tails += e.heavy_tailed ? 1 : 0;
      const double factor = e.heavy_tailed ? 8.0 : 2.0;  // three times as wide in the logarithm
      wide += range.high > factor * range.low ? 1 : 0;
    }
  }
  std::printf("%s: %.0f of %.0f forecasts held; from %d samples on %.0f of %.0f too wide, %.0f flagged\n",
              GetParam().name, hits, scored, static_cast<int>(kSampleFloor), wide, late, tails);
  EXPECT_GE(scored, 2 * seeds);
  if (tests::kSanitized) return;  // 2 seeds say nothing of rates
  EXPECT_GE(hits, 0.9 * scored);
  EXPECT_EQ(wide, 0);
}

TEST_P(Rooms, TargetsAreKept) {
  if (GetParam().target <= 0.0) GTEST_SKIP() << "flagged at any cost that a test can pay";
  if (!GetParam().ordinary && !long_run()) GTEST_SKIP() << "RAYKILN_LONG=1";
  const auto scene = GetParam().scene().prepare();
  server::StopRule rule;
  rule.error = GetParam().target;
  std::vector<std::vector<double>> pictures;
  std::uint64_t samples = 0, most = 0;
  int flagged = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Progress job(*scene, square(16, 300 + seed));
    ImageError e;
    for (std::uint64_t next = server::kErrorFloor; next <= kMostSamples; next = server::next_decision(job.samples())) {
      job.advance_to(next);
      e = job.error();
      if (server::target_met(rule, as_judged(e))) break;
    }
    ASSERT_TRUE(server::target_met(rule, as_judged(e))) << "not within " << kMostSamples << " samples";
    flagged += e.heavy_tailed ? 1 : 0;
    pictures.push_back(job.picture());
    samples += job.samples() / 20;
    most = std::max(most, job.samples());
  }
  Progress reference(*scene, square(16, 299));
  reference.advance_to(24 * samples);
  const std::vector<double> truth = reference.picture();
  int kept = 0, above = 0;
  double least = 1e9, largest = 0.0;
  for (const auto& picture : pictures) {
    const double ratio = true_error(picture, truth).error / GetParam().target;
    kept += ratio >= 0.7 && ratio <= 1.05 ? 1 : 0;
    above += ratio > 1.05 ? 1 : 0;
    least = std::min(least, ratio);
    largest = std::max(largest, ratio);
  }
  std::printf("%s: target %g, %llu samples (at most %llu), flagged %d of 20, true error %.3f to %.3f of the target, kept %d of 20\n",
              GetParam().name, GetParam().target, static_cast<unsigned long long>(samples),
              static_cast<unsigned long long>(most), flagged, least, largest, kept);
  EXPECT_LE(above, 2);  // flagged or not: nobody gets less than what was asked for
  if (flagged < 19) {
    EXPECT_GE(kept, 18);
  }
  EXPECT_GE(least, 0.4) << "a flag may cost time, not without end";
}

INSTANTIATE_TEST_SUITE_P(Small, Rooms,
                         ::testing::Values(Room{"diffuse_with_area_light", support::diffuse_with_area_light, 0.05, true},
                                           Room{"lamp_over_a_slit", support::lamp_over_a_slit, 0.0, true},
                                           Room{"glass_with_caustic", support::glass_with_caustic, 0.1, false}),
                         [](const auto& tested) { return std::string(tested.param.name); });

}  // namespace
}  // namespace raykiln::render
