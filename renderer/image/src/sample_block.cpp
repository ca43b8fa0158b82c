#include <algorithm>

#include "raykiln/image/film.hpp"

namespace raykiln::render {
namespace {

constexpr std::uint64_t kBlockLength = 16;    ///< samples of every block from sample 16 on
constexpr std::uint64_t kGrowingBlocks = 5;   ///< blocks that end at 1, 2, 4, 8, 16

std::uint64_t border_after(std::uint64_t index) {
  if (index < kGrowingBlocks) return std::uint64_t{1} << index;
  return kBlockLength * (index - kGrowingBlocks + 2);
}

}  // namespace

SampleBlock sample_block(std::uint64_t index) {
  const std::uint64_t first = index == 0 ? 0 : border_after(index - 1);
  return {.index = index, .first = first, .count = border_after(index) - first, .complete = true};
}

std::size_t replicate_of(std::uint64_t block_index) {
  return block_index < kGrowingBlocks ? 0 : (block_index - kGrowingBlocks + 1) % kReplicates;
}

std::vector<SampleBlock> blocks_for(std::uint64_t samples) {
  std::vector<SampleBlock> blocks;
  for (std::uint64_t index = 0;; ++index) {
    SampleBlock block = sample_block(index);
    if (block.first >= samples) return blocks;
    const std::uint64_t wanted = std::min(block.count, samples - block.first);
    block.complete = wanted == block.count;
    block.count = wanted;
    blocks.push_back(block);
  }
}

}  // namespace raykiln::render
