#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "raykiln/study/study.hpp"
#include "support/scene_pieces.hpp"

namespace raykiln::render {
namespace {

RenderSettings small_view(int side = 8) {
  RenderSettings view;
  view.width = view.height = side;
  return view;
}

/// The inside of a grey cube that shines a little everywhere: radiance 0.1 / (1 - 0.5) = 0.2.
std::shared_ptr<const Scene> furnace() {
  support::SceneBuilder b;
  b.box(Vec3f(-1.0F), Vec3f(1.0F), b.material(support::diffuse_material(Rgb(0.5F), Rgb(0.1F))));
  b.look({0.1, 0.2, 0.3}, {1, 0.3, 0.1}, {0, 0, 1}, 1.0);
  return std::make_shared<const Scene>(b.scene());
}

std::vector<Variant> chosen(const Scene& scene, const std::vector<std::string>& names, int side = 8) {
  std::vector<Variant> result;
  for (const Variant& v : knob_variants(small_view(side), scene)) {
    if (std::find(names.begin(), names.end(), v.name) != names.end()) result.push_back(v);
  }
  return result;
}

/// One pass of each variant, and a reference that is exact enough: no clock decides how many samples are taken, so
/// that what is found is the same on every machine.
constexpr StudyBudget kByNoClock{.seconds = 0.0, .reference_seconds = 1e9};

// With roulette the furnace is exactly 0.2; after 2 reflections 0.1 (1 + 0.5 + 0.25) = 0.175, 12.5 % less.
TEST(MeasureKnobs, FindsTheBiasOfAFixedDepthAndNoneInTheDefaults) {
  const auto scene = furnace();
  SerialTaskRunner runner;
  const Study study = measure_knobs(scene, chosen(*scene, {"defaults", "depth=2", "emitters=bsdf"}, 16), kByNoClock, runner,
                                    [](const std::string&, double) {});
  EXPECT_TRUE(study.reference.exact_enough());
  ASSERT_EQ(study.curves.size(), 3U);
  EXPECT_FALSE(study.curves[0].bias.certain);
  EXPECT_LT(std::abs(study.curves[0].bias.brightness), 5.0 * study.curves[0].bias.brightness_error + 1e-9);
  EXPECT_TRUE(study.curves[1].bias.certain);
  // relMSE divides by r^2 + 0.01 M^2: 0.125 / sqrt(1.01).
  EXPECT_NEAR(study.curves[1].bias.value, 0.125 / std::sqrt(1.01), 0.01);
  EXPECT_NEAR(study.curves[1].bias.brightness, -0.125, 0.01);
  EXPECT_FALSE(study.curves[2].bias.certain);
}

TEST(MeasureKnobs, SaysWhetherTheReferenceIsExactEnough) {
  const auto scene = furnace();
  SerialTaskRunner runner;
  const auto variants = chosen(*scene, {"defaults"});
  const auto quiet = [](const std::string&, double) {};
  const Study rough = measure_knobs(scene, variants, {.seconds = 0.05, .reference_seconds = 1e-6}, runner, quiet);
  EXPECT_FALSE(rough.reference.exact_enough());
  EXPECT_GT(rough.reference.error, 0.0);
}

TEST(MeasureKnobs, ErrorsFallWithSamplesAndTimesRise) {
  const auto scene = furnace();
  SerialTaskRunner runner;
  const Study study = measure_knobs(scene, chosen(*scene, {"defaults"}), {.seconds = 0.15, .reference_seconds = 1.5}, runner,
                                    [](const std::string&, double) {});
  const auto& points = study.curves[0].points;
  ASSERT_GE(points.size(), 3U);
  EXPECT_EQ(points[0].samples, 2U);
  for (std::size_t i = 1; i < points.size(); ++i) {
    EXPECT_EQ(points[i].samples, 2 * points[i - 1].samples);
    EXPECT_GT(points[i].seconds, points[i - 1].seconds);
  }
  EXPECT_LT(points.back().error, points.front().error);
}

TEST(MeasureKnobs, ABlackPictureHasNoErrorAndEnds) {
  support::SceneBuilder b;
  b.level_square(1.0F, 0.0F, b.material(support::diffuse_material(Rgb(0.5F))), true);
  b.look({0, 0, 3}, {0, 0, 0}, {0, 1, 0}, 0.5);
  const auto scene = std::make_shared<const Scene>(b.scene());
  SerialTaskRunner runner;
  const Study study = measure_knobs(scene, chosen(*scene, {"defaults"}), {.seconds = 1e-3, .reference_seconds = 1e-2}, runner,
                                    [](const std::string&, double) {});
  EXPECT_EQ(study.reference.smallest_error, 0.0);
  EXPECT_FALSE(study.reference.exact_enough());
  for (const StudyPoint& point : study.curves[0].points) EXPECT_EQ(point.error, 0.0);
}

TEST(Curves, AreReadExactlyOnAPowerLaw) {
  std::vector<StudyPoint> points;
  for (int i = 0; i < 5; ++i) {
    const double seconds = 0.1 * std::exp2(i);
    points.push_back({.samples = 2U << i, .seconds = seconds, .error = 0.3 / std::sqrt(seconds)});
  }
  EXPECT_NEAR(error_at(points, 0.7), 0.3 / std::sqrt(0.7), 1e-12);
  EXPECT_NEAR(seconds_to(points, 0.5), 0.36, 1e-12);
  EXPECT_LT(error_at(points, 0.05), 0.0);
  EXPECT_LT(error_at(points, 2.0), 0.0);
  EXPECT_LT(seconds_to(points, 0.1), 0.0);
  EXPECT_EQ(seconds_to(points, 5.0), 0.1);
}

}  // namespace
}  // namespace raykiln::render
