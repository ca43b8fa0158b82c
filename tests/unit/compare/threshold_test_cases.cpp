#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "raykiln/compare/maps.hpp"
#include "raykiln/compare/threshold_test.hpp"
#include "synthetic_pair.hpp"

namespace raykiln::render {
namespace {

Image flat(float value) {
  return {.width = 10, .height = 10, .rgb = std::vector<float>(300, value)};
}

TEST(ThresholdTest, BothLimitsMustBePassed) {
  const Thresholds limits{.absolute = 0.01, .relative = 0.05, .failing_share = 0.0};
  EXPECT_FALSE(test_thresholds(flat(1.04F), flat(1.0F), limits).differs);   // relative holds
  EXPECT_FALSE(test_thresholds(flat(0.009F), flat(0.0F), limits).differs);  // absolute holds
  EXPECT_TRUE(test_thresholds(flat(1.06F), flat(1.0F), limits).differs);
}

TEST(ThresholdTest, SomePixelsMayFailButNoneBeyondTheHardLimit) {
  Image a = flat(1.0F);
  a.rgb[3 * 47 + 1] = 1.5F;
  const ThresholdVerdict one = test_thresholds(a, flat(1.0F), {.failing_share = 0.01});
  EXPECT_FALSE(one.differs);
  EXPECT_EQ(one.failing_pixels, 1U);
  EXPECT_NEAR(one.largest, 0.5, 1e-6);
  EXPECT_EQ(one.x, 7);
  EXPECT_EQ(one.y, 4);
  EXPECT_TRUE(test_thresholds(a, flat(1.0F), {.failing_share = 0.009}).differs);
  EXPECT_TRUE(test_thresholds(a, flat(1.0F), {.failing_share = 0.01, .hard_limit = 0.4}).differs);
}

TEST(ThresholdTest, NotFiniteInOneAloneFails) {
  Image a = flat(1.0F);
  a.rgb[0] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(test_thresholds(a, flat(1.0F), {.failing_share = 0.5}).differs);
  EXPECT_FALSE(test_thresholds(a, a, {}).differs);
}

TEST(DifferenceFigures, OfAKnownDifference) {
  Image a = flat(1.0F);
  for (std::size_t i = 0; i < 150; ++i) a.rgb[i] = 1.2F;
  const DifferenceFigures figures = difference_figures(a, flat(1.0F));
  EXPECT_NEAR(figures.mean_render, 1.1, 1e-6);
  EXPECT_NEAR(figures.mean_absolute, 0.1, 1e-6);
  EXPECT_NEAR(figures.rmse, std::sqrt(0.02), 1e-6);
  EXPECT_NEAR(figures.relmse, 0.02 / 1.01, 1e-6);
  EXPECT_NEAR(figures.psnr_db, -20.0 * std::log10(std::sqrt(0.02)), 1e-4);
  EXPECT_EQ(difference_figures(flat(2.0F), flat(2.0F)).psnr_db, 999.0);
}

TEST(Maps, ColoursSayWhichPictureIsBrighter) {
  Image a = flat(1.0F);
  a.rgb[0] = a.rgb[1] = a.rgb[2] = 2.0F;
  a.rgb[3] = a.rgb[4] = a.rgb[5] = 0.0F;
  const Image map = difference_picture(a, flat(1.0F));
  EXPECT_GT(map.rgb[0], map.rgb[2]);                  // red: brighter
  EXPECT_LT(map.rgb[3], map.rgb[5]);                  // blue: darker
  EXPECT_EQ(map.rgb[6], map.rgb[8]);                  // grey: equal
}

TEST(Maps, ZMapIsWhiteWhereNothingDiffersAndRedWhereTheRenderIsBrighter) {
  using namespace synthetic;
  const auto at = [](double level) {
    return [level](Random& r, int x, int) { return (x < 16 ? level : 1.0) * exponential(r); };
  };
  const auto a = measure(32, 16, 64, 1, at(2.0)), b = measure(32, 16, 64, 2, at(1.0));
  const Image map = z_map(a, b);
  const std::size_t changed = 3 * (8 * 32 + 8), same = 3 * (8 * 32 + 26);
  EXPECT_GT(map.rgb[changed], 2.0F * map.rgb[changed + 2]);
  EXPECT_GT(map.rgb[same + 2], 0.3F);
  EXPECT_GT(map.rgb[same], 0.3F);
}

}  // namespace
}  // namespace raykiln::render
