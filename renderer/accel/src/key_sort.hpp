// Sorting of event keys in linear time, whatever the keys are.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "build_context.hpp"

namespace raykiln::render {

/// Below this many keys a comparison sort is faster.
inline constexpr std::size_t kRadixSortMin = 256;

/// Sorts ascending by bits [low_bit, 64): stable LSD radix sort, or std::sort on all bits for few
/// keys. With low_bit > 0 the caller vouches that keys equal above low_bit stand in ascending
/// order already, so both give the same. `scratch` grows to keys.size(). A stop leaves the keys in
/// some order. `context` may be null. Returns keys x passes, or the comparisons of the small sort.
std::uint64_t sort_keys(std::span<std::uint64_t> keys, unsigned low_bit,
                        std::vector<std::uint64_t>& scratch, BuildContext* context = nullptr);

}  // namespace raykiln::render
