#include <gtest/gtest.h>

#include "raykiln/image/film.hpp"

namespace raykiln::render {
namespace {

TEST(SampleBlock, BordersGrowAndThenStayApartBySixteen) {
  const std::vector<std::uint64_t> borders{0, 1, 2, 4, 8, 16, 32, 48, 64, 80};
  for (std::size_t i = 0; i + 1 < borders.size(); ++i) {
    const SampleBlock block = sample_block(i);
    EXPECT_EQ(block.index, i);
    EXPECT_EQ(block.first, borders[i]);
    EXPECT_EQ(block.first + block.count, borders[i + 1]);
    EXPECT_TRUE(block.complete);
  }
}

TEST(SampleBlock, CoverEveryCountExactlyOnce) {
  for (std::uint64_t samples = 0; samples <= 70; ++samples) {
    std::uint64_t next = 0;
    const auto blocks = blocks_for(samples);
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      EXPECT_EQ(blocks[i].index, i);
      EXPECT_EQ(blocks[i].first, next);
      EXPECT_GT(blocks[i].count, 0U);
      EXPECT_EQ(blocks[i].complete, blocks[i].count == sample_block(i).count);
      EXPECT_TRUE(blocks[i].complete || i + 1 == blocks.size());
      next += blocks[i].count;
    }
    EXPECT_EQ(next, samples);
  }
}

TEST(SampleBlock, IndicesBeyondThirtyTwoBits) {
  const SampleBlock block = sample_block(std::uint64_t{1} << 40);
  EXPECT_EQ(block.first, 16 * ((std::uint64_t{1} << 40) - 4));
  EXPECT_EQ(block.count, 16U);
}

}  // namespace
}  // namespace raykiln::render
