// Two pictures of one distribution: the test must stay silent as often as it says.
#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>
#include <string_view>

#include "raykiln/compare/noise_test.hpp"
#include "synthetic_pair.hpp"

namespace raykiln::render {
namespace {

using namespace synthetic;

constexpr double kStated = 0.05;

int pairs() {
  const char* value = std::getenv("RAYKILN_LONG");
  return value != nullptr && std::string_view(value) == "1" ? 1000 : 100;
}

/// Most alarms among so many pairs that a true rate of 5 % gives in all but 1 of 10000 runs, by the
/// normal approximation with continuity: a test that keeps its promise passes with this chance.
int most_alarms() {
  const double n = pairs();
  return static_cast<int>(n * kStated + 3.72 * std::sqrt(n * kStated * (1.0 - kStated)) + 0.5);
}

int alarms(const Sample& sample, int render_samples, int reference_samples) {
  int count = 0;
  for (int pair = 0; pair < pairs(); ++pair) {
    const auto seed = static_cast<std::uint64_t>(pair);
    const auto a = measure(48, 40, render_samples, 2 * seed, sample);
    const auto b = measure(48, 40, reference_samples, 2 * seed + 1, sample);
    count += test_noise(a, b, {.false_alarms = kStated}).differs ? 1 : 0;
  }
  return count;
}

void check(const char* what, const Sample& sample, int render_samples, int reference_samples) {
  const int count = alarms(sample, render_samples, reference_samples);
  std::printf("%s, %d against %d samples: %d alarms in %d pairs, stated share %.0f %%\n", what, render_samples,
              reference_samples, count, pairs(), 100.0 * kStated);
  EXPECT_LE(count, most_alarms()) << what;
}

double graded(Random& random, int x, int y) { return (1.0 + x) * (y < 10 ? 0.0 : 1.0) * exponential(random); }

TEST(NoiseTestAlarms, Exponential) {
  check("exponential", graded, 16, 16);
  check("exponential", graded, 4, 4);
}
TEST(NoiseTestAlarms, ExponentialAgainstALongReference) {
  check("exponential", graded, 8, 64);
  check("exponential", graded, 64, 8);
}
TEST(NoiseTestAlarms, OneSample) { check("exponential", graded, 1, 1); }
TEST(NoiseTestAlarms, RareBrightPaths) {
  check("rare spike", [](Random& r, int, int) { return rare_spike(r); }, 16, 16);
  check("rare spike", [](Random& r, int, int) { return rare_spike(r); }, 8, 64);
}
TEST(NoiseTestAlarms, InfiniteVariance) {
  check("heavy tail", [](Random& r, int, int) { return heavy_tail(r); }, 16, 16);
  check("heavy tail", [](Random& r, int, int) { return heavy_tail(r); }, 8, 64);
}

TEST(NoiseTestAlarms, UnknownErrorsCountAsOneSample) {
  const auto lost = [](std::uint64_t seed, double by) {
    auto image = measure(24, 24, 16, seed, [by](Random& r, int, int) { return by * exponential(r); });
    std::fill(image.error.begin(), image.error.end(), std::numeric_limits<float>::quiet_NaN());
    return image;
  };
  EXPECT_FALSE(test_noise(lost(1, 1.0), lost(2, 1.0), {}).differs);
  EXPECT_TRUE(test_noise(lost(1, 2.0), lost(2, 1.0), {}).differs);
}

TEST(NoiseTestAlarms, EqualPicturesHaveNoEvidence) {
  const auto a = measure(20, 10, 8, 1, graded);
  const NoiseVerdict verdict = test_noise(a, a, {});
  EXPECT_FALSE(verdict.differs);
  EXPECT_EQ(verdict.strongest.kind, EvidenceKind::kNone);
  EXPECT_EQ(verdict.chi2, 0.0);
}

TEST(NoiseTestAlarms, RoundingToFloatIsNoDifference) {
  auto a = measure(16, 16, 8, 1, [](Random&, int, int) { return 0.7; });
  auto b = a;
  for (float& value : b.mean.rgb) value = std::nextafter(value, 1.0F);
  EXPECT_FALSE(test_noise(a, b, {.false_alarms = 0.5}).differs);
}

TEST(NoiseTestAlarms, NotFiniteInBothIsCountedAndNoDifference) {
  auto a = measure(16, 16, 8, 1, graded), b = measure(16, 16, 8, 2, graded);
  a.mean.rgb[300] = b.mean.rgb[300] = std::numeric_limits<float>::quiet_NaN();
  const NoiseVerdict verdict = test_noise(a, b, {});
  EXPECT_FALSE(verdict.differs);
  EXPECT_EQ(verdict.render_not_finite, 1U);
  EXPECT_EQ(verdict.reference_not_finite, 1U);
}

TEST(NoiseTestAlarms, OfNoiseTheMeanSquareIsOne) {
  const auto a = measure(64, 64, 64, 5, graded), b = measure(64, 64, 64, 6, graded);
  EXPECT_NEAR(test_noise(a, b, {}).chi2, 1.0, 0.06);  // 3 standard deviations of sqrt(2 / 3072)
}

}  // namespace
}  // namespace raykiln::render
