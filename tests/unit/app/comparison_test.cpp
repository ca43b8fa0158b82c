#include "raykiln/app/comparison.hpp"

#include <gtest/gtest.h>

#include "raykiln/image/encode.hpp"

namespace raykiln::server {
namespace {

render::Image flat(int width, float value) {
  return {.width = width, .height = 4, .rgb = std::vector<float>(static_cast<std::size_t>(12 * width), value)};
}

std::vector<std::uint8_t> exr(const render::Image& image) {
  return std::get<render::Bytes>(render::encode_exr(image, {{"raykiln:seed", "3"}}));
}

bool holds(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(Comparison, WithoutNoiseThresholdsDecideAndItIsSaid) {
  const auto same = compare_pictures(exr(flat(4, 0.5F)), exr(flat(4, 0.501F)), {}, true);
  EXPECT_EQ(same.method, ComparisonMethod::kThresholds);
  EXPECT_FALSE(same.differs);
  EXPECT_TRUE(same.same_seed);
  EXPECT_TRUE(holds(comparison_text(same), "noise was not taken into account"));
  EXPECT_TRUE(holds(comparison_json(same), "\"noise_considered\":false"));
  EXPECT_FALSE(same.difference_png.empty());
  EXPECT_TRUE(same.z_map_png.empty());
  const auto changed = compare_pictures(exr(flat(4, 0.5F)), exr(flat(4, 0.6F)), {}, false);
  EXPECT_TRUE(changed.differs);
  EXPECT_TRUE(holds(comparison_json(changed), "\"verdict\":\"differs\""));
}

TEST(Comparison, APngIsComparedInDisplayValues) {
  const auto png = std::get<render::Bytes>(render::encode_png(flat(4, 0.2F), 0.0));
  const auto same = compare_pictures(exr(flat(4, 0.2F)), png, {}, false);
  EXPECT_TRUE(same.display_values);
  EXPECT_FALSE(same.differs);
  EXPECT_LT(same.figures.largest, 0.51 / 255.0);
}

TEST(Comparison, UnlikeSizesDifferAndNoPictureIsUnreadable) {
  const auto sizes = compare_pictures(exr(flat(4, 0.5F)), exr(flat(5, 0.5F)), {}, true);
  EXPECT_TRUE(sizes.differs);
  EXPECT_FALSE(sizes.unreadable);
  EXPECT_EQ(sizes.method, ComparisonMethod::kNone);
  EXPECT_TRUE(holds(sizes.reason, "4 x 4 against 5 x 4"));
  const std::vector<std::uint8_t> junk{1, 2, 3};
  const auto unreadable = compare_pictures(exr(flat(4, 0.5F)), junk, {}, true);
  EXPECT_TRUE(unreadable.unreadable);
  EXPECT_TRUE(holds(unreadable.reason, "reference"));
}

}  // namespace
}  // namespace raykiln::server
