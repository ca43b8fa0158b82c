// Pictures of two distributions: what is to be found, and where it is said to be.
#include <gtest/gtest.h>

#include <limits>

#include "raykiln/compare/noise_test.hpp"
#include "synthetic_pair.hpp"

namespace raykiln::render {
namespace {

using namespace synthetic;

constexpr int kRuns = 40;

double noise(Random& random, int, int) { return exponential(random); }

/// Share of runs in which `changed` is told from plain exponential noise, at the default rate.
double found(int side, int samples, const Sample& changed, const NoiseTestSettings& settings = {}) {
  int count = 0;
  for (int run = 0; run < kRuns; ++run) {
    const auto seed = static_cast<std::uint64_t>(run);
    const auto render = measure(side, side, samples, 2 * seed + 1000, changed);
    const auto reference = measure(side, side, samples, 2 * seed + 1001, noise);
    count += test_noise(render, reference, settings).differs ? 1 : 0;
  }
  return count / static_cast<double>(kRuns);
}

TEST(NoiseTestPower, AUniformShiftSmallerThanAnyPixelsNoise) {
  // 96 x 96 x 16 samples: the shift of the mean is known to 0.37 %, so 3 % is eight of that.
  EXPECT_GE(found(96, 16, [](Random& r, int x, int y) { return 1.03 * noise(r, x, y); }), 0.95);
}

TEST(NoiseTestPower, ABlockWhoseMeanMoved) {
  const auto changed = [](Random& r, int x, int y) {
    return (x >= 30 && x < 46 && y >= 20 && y < 36 ? 1.3 : 1.0) * noise(r, x, y);
  };
  EXPECT_GE(found(64, 16, changed), 0.95);
}

TEST(NoiseTestPower, SpotsThatCancelInEveryLargeBlock) {
  // Squares of 4 x 4 pixels, brighter and darker in turn, each of them within its noise.
  const auto changed = [](Random& r, int x, int y) { return ((x / 4 + y / 4) % 2 == 0 ? 1.1 : 0.9) * noise(r, x, y); };
  EXPECT_GE(found(64, 16, changed), 0.95);
}

TEST(NoiseTestPower, OnePixel) {
  const auto changed = [](Random& r, int x, int y) { return (x == 31 && y == 7 ? 3.0 : 0.0) + noise(r, x, y); };
  EXPECT_GE(found(64, 64, changed), 0.95);
}

TEST(NoiseTestPower, AChangeWithoutNoise) {
  const auto flat = [](double level) {
    return [level](Random&, int x, int y) { return x < 8 && y < 8 ? level : 0.5; };
  };
  const auto a = measure(32, 32, 4, 1, flat(0.5)), b = measure(32, 32, 4, 2, flat(0.5001));
  const NoiseVerdict verdict = test_noise(a, b, {});
  EXPECT_TRUE(verdict.differs);
  ASSERT_FALSE(verdict.regions.empty());
  const PixelRect where = verdict.regions.front().where;
  EXPECT_LE(where.x0, 8);
  EXPECT_LE(where.y0, 8);
}

TEST(NoiseTestPower, TheRegionIsWhereTheChangeIs) {
  const auto changed = [](Random& r, int x, int y) { return (x >= 40 && y >= 40 ? 1.5 : 1.0) * noise(r, x, y); };
  const auto a = measure(64, 64, 32, 1, changed), b = measure(64, 64, 32, 2, noise);
  const NoiseVerdict verdict = test_noise(a, b, {});
  ASSERT_FALSE(verdict.regions.empty());
  EXPECT_GE(verdict.regions.front().where.x0, 32);
  EXPECT_GE(verdict.regions.front().where.y0, 32);
  EXPECT_GT(verdict.regions.front().z, 0.0);
  EXPECT_LE(verdict.regions.front().family_chance, 0.001);
  for (std::size_t i = 0; i < verdict.regions.size(); ++i) EXPECT_GE(verdict.regions[i].where.x1, 40);
}

TEST(NoiseTestPower, TheShiftIsMeasured) {
  const auto a = measure(96, 96, 32, 1, [](Random& r, int x, int y) { return 1.04 * noise(r, x, y); });
  const auto b = measure(96, 96, 32, 2, noise);
  const NoiseVerdict verdict = test_noise(a, b, {});
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_NEAR(verdict.shift[c], 0.04, 4.0 * verdict.shift_error[c]);
    EXPECT_NEAR(verdict.shift_error[c], std::sqrt(2.0 / (96.0 * 96.0 * 32.0)), 0.0003);
  }
  EXPECT_GT(verdict.smallest_uniform_change, 3.0 * verdict.shift_error[0]);
  EXPECT_LT(verdict.smallest_uniform_change, 7.0 * verdict.shift_error[0]);
}

TEST(NoiseTestPower, ToleranceForgivesWhatItSays) {
  const auto shifted = [](double by) {
    return [by](Random& r, int x, int y) { return by * noise(r, x, y); };
  };
  EXPECT_EQ(found(64, 64, shifted(1.02), {.tolerance = 0.03}), 0.0);
  EXPECT_GE(found(64, 64, shifted(1.08), {.tolerance = 0.03}), 0.95);
}

TEST(NoiseTestPower, APixelThatIsFiniteInOnePictureAlone) {
  auto a = measure(16, 16, 8, 1, noise), b = measure(16, 16, 8, 2, noise);
  a.mean.rgb[30] = std::numeric_limits<float>::infinity();
  EXPECT_TRUE(test_noise(a, b, {}).differs);
}

TEST(NoiseTestPower, PicturesOfAnyShape) {
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 7}, {9, 1}, {33, 17}}) {
    const auto size = [w = width, h = height](std::uint64_t seed, double level) {
      return measure(w, h, 64, seed, [level](Random& r, int, int) { return level + exponential(r); });
    };
    EXPECT_FALSE(test_noise(size(1, 1.0), size(2, 1.0), {}).differs) << width << 'x' << height;
    EXPECT_TRUE(test_noise(size(1, 4.0), size(2, 1.0), {}).differs) << width << 'x' << height;
  }
}

}  // namespace
}  // namespace raykiln::render
