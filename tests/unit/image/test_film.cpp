#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "raykiln/image/film.hpp"
#include "raykiln/image/layers.hpp"

namespace raykiln::render {
namespace {

/// A block of one pixel that holds these grey samples.
BlockResult block_of(std::uint64_t index, const std::vector<double>& values, bool complete = true) {
  BlockResult result{.block = sample_block(index), .planes = make_block_planes(1)};
  result.block.complete = complete;
  result.block.count = values.size();
  for (const double value : values) add_sample(result.planes, 0, Rgbd(value), false);
  return result;
}
const PixelRect kOnePixel{0, 0, 1, 1};

TEST(Film, BytesPerPixelAreStatedAndModest) {
  EXPECT_EQ(Film::bytes_per_pixel(), 216U);
}

TEST(Film, MeanAndMomentsMatchTheTwoPassFormula) {
  const std::vector<std::vector<double>> blocks{{1.0}, {4.0}, {2.0, 8.0}, {0.0, 1.0, 1.0, 7.0}};
  Film film(1, 1);
  std::vector<double> all;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    film.fold(kOnePixel, block_of(b, blocks[b]));
    all.insert(all.end(), blocks[b].begin(), blocks[b].end());
  }
  double mean = 0.0, moment = 0.0;
  for (const double x : all) mean += x / static_cast<double>(all.size());
  for (const double x : all) moment += (x - mean) * (x - mean);
  EXPECT_NEAR(film.resolve().rgb[1], mean, 1e-6);
  EXPECT_NEAR(film.plane("luminance_moment")[0], moment, 1e-12 * moment);
  EXPECT_EQ(film.plane("samples")[0], 8.0);
  EXPECT_EQ(film.plane("largest")[0], luminance(Rgbd(8.0)));
  EXPECT_EQ(film.plane("luminance_count"), (std::vector<double>{8, 0, 0, 0}));
  EXPECT_NEAR(film.plane("luminance_sum")[0], 24.0, 1e-12);
}

TEST(Film, ChannelsHaveMomentsOfTheirOwn) {
  const std::vector<Rgbd> samples{{1, 0, 3}, {2, 0, 3}, {6, 0, 3}, {7, 1, 3}};
  Film film(1, 1);
  for (std::uint64_t b = 0, i = 0; b < 3; ++b) {
    BlockResult block{.block = sample_block(b), .planes = make_block_planes(1)};
    for (std::uint64_t k = 0; k < block.block.count; ++k) add_sample(block.planes, 0, samples[i++], false);
    film.fold(kOnePixel, block);
  }
  const std::vector<double> moment = film.plane("moment");
  EXPECT_NEAR(moment[0], 26.0, 1e-12);
  EXPECT_NEAR(moment[1], 0.75, 1e-12);
  EXPECT_EQ(moment[2], 0.0);
  EXPECT_EQ(film.pixel(0).samples(), 4U);
}

// 1000 +- 0.01: the difference of squares would lose every digit in float and eight in double.
TEST(Film, VarianceSurvivesALargeMean) {
  Film film(1, 1);
  for (std::uint64_t b = 0; b < 1000; ++b) {
    std::vector<double> values(sample_block(b).count);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = 1000.0 + (i % 2 == 0 ? 0.01 : -0.01);
    film.fold(kOnePixel, block_of(b, values));
  }
  const double n = film.plane("samples")[0];
  EXPECT_NEAR(film.plane("luminance_moment")[0] / n, 1e-4, 1e-10);
}

TEST(Film, IncompleteBlockIsReplacedByTheWholeOne) {
  Film extended(1, 1), direct(1, 1);
  extended.fold(kOnePixel, block_of(0, {1.0}));
  extended.fold(kOnePixel, block_of(1, {2.0}));
  extended.fold(kOnePixel, block_of(2, {5.0}, false));
  EXPECT_EQ(extended.plane("samples")[0], 3.0);
  EXPECT_NEAR(extended.resolve().rgb[0], 8.0 / 3.0, 1e-6);
  extended.fold(kOnePixel, block_of(2, {5.0, 6.0}));

  for (std::uint64_t b = 0; b < 3; ++b) {
    direct.fold(kOnePixel, block_of(b, b == 2 ? std::vector<double>{5.0, 6.0}
                                              : std::vector<double>{static_cast<double>(b) + 1.0}));
  }
  for (const PlaneSpec& spec : film_planes()) {
    EXPECT_EQ(extended.plane(spec.name), direct.plane(spec.name)) << spec.name;
  }
}

TEST(Film, NonFiniteSamplesAreDroppedAndCountedPerKind) {
  // The build must not use -ffinite-math-only: this also fails if isnan is optimised away.
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  const BlockResult block = block_of(4, {1.0, nan, inf, -inf, 1e39, -1.0, 2.0});
  Film film(1, 1);
  film.fold(kOnePixel, block);
  EXPECT_EQ(film.plane("samples")[0], 3.0);
  EXPECT_EQ(film.plane("nan")[0], 1.0);
  EXPECT_EQ(film.plane("inf")[0], 3.0);
  EXPECT_EQ(film.plane("negative")[0], 1.0);
  EXPECT_NEAR(film.resolve().rgb[0], 2.0 / 3.0, 1e-6);
}

// Who resolves each tile after its fold has the same picture as who resolves the whole film.
TEST(Film, ResolvesPartByPart) {
  Film film(3, 2);
  Image kept{.width = 3, .height = 2, .rgb = std::vector<float>(18)};
  for (std::uint64_t b = 0; b < 3; ++b) {
    for (const PixelRect part : {PixelRect{0, 0, 2, 1}, PixelRect{1, 1, 3, 2}}) {
      BlockResult block{.block = sample_block(b), .planes = make_block_planes(2)};
      for (std::size_t i = 0; i < 2 * block.block.count; ++i) {
        const double x = static_cast<double>(i + b) + part.x0;
        add_sample(block.planes, i % 2, {x, 2.0 * x, 0.5}, false);
      }
      film.fold(part, block);
      film.resolve(part, kept);
      EXPECT_EQ(kept.rgb, film.resolve().rgb);
    }
  }
}

TEST(Film, TileGoesToItsPlaceAndUnsampledPixelsStayBlack) {
  Film film(3, 2);
  BlockResult block{.block = sample_block(0), .planes = make_block_planes(2)};
  add_sample(block.planes, 0, {1.0, 2.0, 3.0}, false);
  add_sample(block.planes, 1, {4.0, 5.0, 6.0}, true);
  film.fold({1, 1, 3, 2}, block);
  const std::vector<float> expected{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 2, 3, 4, 5, 6};
  EXPECT_EQ(film.resolve().rgb, expected);
  EXPECT_EQ(film.plane("truncated"), (std::vector<double>{0, 0, 0, 0, 0, 1}));
  EXPECT_TRUE(film.plane("no such plane").empty());
}

TEST(Film, RefusesABlockThatDoesNotFit) {
  Film film(3, 2);
  const BlockResult block{.block = sample_block(0), .planes = make_block_planes(2)};
  EXPECT_THROW(film.fold({2, 0, 4, 1}, block), std::invalid_argument);
  EXPECT_THROW(film.fold({-1, 0, 1, 1}, block), std::invalid_argument);
  EXPECT_THROW(film.fold({0, 0, 1, 1}, block), std::invalid_argument);
  EXPECT_THROW(film.fold({0, 0, 2, 1}, {.block = sample_block(0), .planes = {}}), std::invalid_argument);
  EXPECT_NO_THROW(film.fold({0, 0, 2, 1}, block));
}

TEST(Film, AHundredMillionOnesAddUp) {
  // Whole blocks of ones, written without rendering them: double sums do not stop at 2^24.
  Film film(1, 1);
  BlockResult block = block_of(7, std::vector<double>(16, 1.0));
  block.planes.planes[BlockPlane::kBeauty] = {1e6, 1e6, 1e6};
  block.planes.planes[BlockPlane::kSamples] = {1e6};
  for (int i = 0; i < 100; ++i) film.fold(kOnePixel, block);
  EXPECT_EQ(film.plane("beauty")[0], 1e8);
  EXPECT_EQ(film.resolve().rgb[0], 1.0F);
}

LayerBlock layer_block(std::uint64_t index, double albedo, bool counts = true) {
  LayerSet set = *layer_set_of("albedo,depth,material_id");
  LayerBlock block = make_layer_block(sample_block(index), set, 1);
  LayerSample sample;
  sample.met = true;
  sample.albedo = Rgbd(albedo);
  sample.depth = albedo;
  sample.material = static_cast<std::uint32_t>(10.0 * albedo);
  add_sample(block, 0, block.block.first, sample, counts);
  return block;
}

TEST(LayerFilm, HoldsMeansAndTheFirstSamplesNumber) {
  LayerFilm film(*layer_set_of("albedo,depth,material_id"), 1, 1);
  for (std::uint64_t b = 0; b < 3; ++b) film.fold(kOnePixel, layer_block(b, 1.0 + static_cast<double>(b)));
  const std::vector<float> three{3.0F}, none{0.0F};
  EXPECT_EQ(film.resolve(Layer::kAlbedo, three), (std::vector<float>{2.0F, 2.0F, 2.0F}));
  EXPECT_EQ(film.resolve(Layer::kDepth, none), (std::vector<float>{2.0F})) << "of what met something";
  EXPECT_EQ(film.resolve(Layer::kMaterialId, three), (std::vector<float>{10.0F}));
  EXPECT_EQ(film.resolve(Layer::kAlbedo, none), (std::vector<float>(3, 0.0F)));
  EXPECT_TRUE(film.resolve(Layer::kNormal, three).empty()) << "not asked for";
  EXPECT_THROW(film.fold({0, 0, 2, 1}, layer_block(0, 1.0)), std::invalid_argument);
  EXPECT_THROW((void)film.resolve(Layer::kAlbedo, {}), std::invalid_argument);
}

TEST(LayerFilm, KeepsAnIncompleteBlockApart) {
  LayerFilm film(*layer_set_of("albedo,depth,material_id"), 1, 1);
  film.fold(kOnePixel, layer_block(0, 1.0));
  LayerBlock part = layer_block(1, 5.0);
  part.block.complete = false;
  film.fold(kOnePixel, part);
  const std::vector<float> one{1.0F}, two{2.0F};
  EXPECT_EQ(film.resolve(Layer::kAlbedo, two)[0], 3.0F);
  film.fold(kOnePixel, layer_block(1, 2.0));
  EXPECT_EQ(film.resolve(Layer::kAlbedo, two)[0], 1.5F);
  film.fold(kOnePixel, part);
  film.drop_incomplete();
  EXPECT_EQ(film.resolve(Layer::kAlbedo, two)[0], 1.5F);
}

TEST(LayerFilm, ASampleThatIsDroppedLeavesOnlyItsNumber) {
  LayerFilm film(*layer_set_of("albedo,depth,material_id"), 1, 1);
  film.fold(kOnePixel, layer_block(0, 1.0, false));
  const std::vector<float> none{0.0F};
  EXPECT_EQ(film.resolve(Layer::kMaterialId, none)[0], 10.0F);
  EXPECT_TRUE(std::isinf(film.resolve(Layer::kDepth, none)[0]));
}

TEST(LayerSet, ReadsNamesInAnyOrderAndWritesThemInOne) {
  EXPECT_EQ(layer_set_text(*layer_set_of("direct,albedo")), "albedo,direct");
  EXPECT_TRUE(layer_set_of("")->empty());
  for (const char* wrong : {"albedo,", ",albedo", "albedo,albedo", "Albedo", "albedo direct", "beauty"}) {
    EXPECT_FALSE(layer_set_of(wrong)) << wrong;
  }
  EXPECT_EQ(LayerFilm::bytes_per_pixel(LayerSet()), 0U);
  EXPECT_EQ(LayerFilm::bytes_per_pixel(*layer_set_of("albedo,depth")), 2 * 5 * 8 + 4 * 4U);
}

}  // namespace
}  // namespace raykiln::render
