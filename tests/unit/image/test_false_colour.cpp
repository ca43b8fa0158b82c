#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "raykiln/image/false_colour.hpp"

namespace raykiln::render {
namespace {

double brightness(const Image& image, std::size_t i) {
  return luminance({image.rgb[3 * i], image.rgb[3 * i + 1], image.rgb[3 * i + 2]});
}

TEST(FalseColour, BrightnessRisesWithTheValue) {
  std::vector<float> values;
  for (int i = 0; i <= 100; ++i) values.push_back(static_cast<float>(i) / 100.0F);
  const Image image = false_colour(values, 101, 1, {0.0, 1.0, ValueScale::kLinear});
  for (std::size_t i = 1; i < values.size(); ++i) EXPECT_GT(brightness(image, i), brightness(image, i - 1)) << i;
}

TEST(FalseColour, RangesEndAtRoundNumbers) {
  EXPECT_EQ(value_range(std::vector<float>{3.0F, 64.0F}, ValueScale::kLinear).high, 100.0);
  EXPECT_EQ(value_range(std::vector<float>{3.0F, 50.0F}, ValueScale::kLinear).high, 50.0);
  const ValueRange range = value_range(std::vector<float>(1000, 0.013F), ValueScale::kLog);
  EXPECT_DOUBLE_EQ(range.high, 0.02);
  EXPECT_DOUBLE_EQ(range.low, 0.02e-3);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(value_range(std::vector<float>{nan, nan}, ValueScale::kLog).high, 1.0);
  EXPECT_EQ(value_range({}, ValueScale::kLinear).high, 1.0);
}

TEST(FalseColour, UnknownIsMagentaAndExtremesAreClipped) {
  const std::vector<float> values{std::numeric_limits<float>::quiet_NaN(), -1.0F, 0.0F, 1e30F,
                                  std::numeric_limits<float>::infinity()};
  const Image image = false_colour(values, 5, 1, {0.01, 10.0, ValueScale::kLog});
  EXPECT_EQ(image.rgb[0], 1.0F);
  EXPECT_EQ(image.rgb[1], 0.0F);
  EXPECT_EQ(image.rgb[2], 1.0F);
  EXPECT_EQ(brightness(image, 1), brightness(image, 2));
  EXPECT_EQ(brightness(image, 3), brightness(image, 4));
  for (const float v : image.rgb) EXPECT_TRUE(std::isfinite(v));
}

}  // namespace
}  // namespace raykiln::render
