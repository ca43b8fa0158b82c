// The builder's kernels for kLanes floats at a time; the including unit says how many. Everything
// has internal linkage, and nothing that another unit compiles, too, is called.
#pragma once

#include "build_kernels.hpp"

#ifdef __SSE2__
#include <immintrin.h>
#endif

namespace raykiln::render {
namespace {

typedef float Floats __attribute__((vector_size(4 * kLanes)));
typedef std::int32_t Ints __attribute__((vector_size(4 * kLanes)));
typedef float Float4 __attribute__((vector_size(16)));
typedef std::int32_t Int4 __attribute__((vector_size(16)));

template <typename To, typename From>
inline To lanes_at(const From* from) {
  To to;
  __builtin_memcpy(&to, from, sizeof to);
  return to;
}
inline Floats all_of(float x) { return x - Floats{}; }
inline Ints all_of(std::int32_t x) { return x - Ints{}; }
inline float lowest(const Floats& x) {
  float least = x[0];
  for (int i = 1; i < kLanes; ++i) least = x[i] < least ? x[i] : least;
  return least;
}
inline bool any(const Ints& mask) {
  std::uint64_t words[kLanes / 2];
  __builtin_memcpy(words, &mask, sizeof words);
  std::uint64_t joined = 0;
  for (const std::uint64_t word : words) joined |= word;
  return joined != 0;
}

constexpr float kInfinite = __builtin_inff();
constexpr float kLargest = 0x1.fffffep127F;
/// More than the roundings of a rough cost, as a share of it.
constexpr float kRoughSlack = 1e-5F;

}  // namespace
}  // namespace raykiln::render
