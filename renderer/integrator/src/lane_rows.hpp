// Rows of memory, one a lane, as vectors with one element a lane, and back: four elements of each row at a time. In
// registers alone: what goes through memory in single elements cannot be read again as a vector before all of it has
// arrived there.
#pragma once

#include "lane_numbers.hpp"

namespace raykiln::render {
namespace {

static_assert(kLanes == 4 || kLanes == 8);

/// Four elements of kLanes rows, in the order of memory: vector j holds row j, and behind it row j + 4 if there are
/// eight lanes. Turned: vector k holds element k of all rows.
template <class V>
struct Fours {
  V v[4];
};

template <class V>
struct HalfOf;
template <>
struct HalfOf<F32> {
  using Type = float __attribute__((vector_size(16)));
};
template <>
struct HalfOf<U64> {
  using Type = std::uint64_t __attribute__((vector_size(32)));
};

/// Four elements of every group of four: 0 to 3 are those of a's group, 4 to 7 those of b's.
constexpr int element(int k) { return k < 4 ? k : k - 4 + kLanes; }
template <int kW, int kX, int kY, int kZ, class V>
V picked(const V& a, const V& b) {
  if constexpr (sizeof(V) == 8 * sizeof(a[0])) {
    return __builtin_shufflevector(a, b, element(kW), element(kX), element(kY), element(kZ), element(kW) + 4,
                                   element(kX) + 4, element(kY) + 4, element(kZ) + 4);
  } else {
    return __builtin_shufflevector(a, b, element(kW), element(kX), element(kY), element(kZ));
  }
}

/// Rows to columns and back: its own inverse. By shuffles that are one instruction each for elements of that size.
inline Fours<F32> turned(const Fours<F32>& r) {
  const F32 low = picked<0, 4, 1, 5>(r.v[0], r.v[1]), low2 = picked<0, 4, 1, 5>(r.v[2], r.v[3]);
  const F32 high = picked<2, 6, 3, 7>(r.v[0], r.v[1]), high2 = picked<2, 6, 3, 7>(r.v[2], r.v[3]);
  return {{picked<0, 1, 4, 5>(low, low2), picked<2, 3, 6, 7>(low, low2), picked<0, 1, 4, 5>(high, high2),
           picked<2, 3, 6, 7>(high, high2)}};
}
inline Fours<U64> turned(const Fours<U64>& r) {
  const U64 even = picked<0, 4, 2, 6>(r.v[0], r.v[1]), even2 = picked<0, 4, 2, 6>(r.v[2], r.v[3]);
  const U64 odd = picked<1, 5, 3, 7>(r.v[0], r.v[1]), odd2 = picked<1, 5, 3, 7>(r.v[2], r.v[3]);
  return {{picked<0, 1, 4, 5>(even, even2), picked<0, 1, 4, 5>(odd, odd2), picked<2, 3, 6, 7>(even, even2),
           picked<2, 3, 6, 7>(odd, odd2)}};
}

template <class V, class Half>
V joined(const Half& low, const Half& high) {
  if constexpr (sizeof(V) == sizeof(Half)) {
    return low;
  } else {
    return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7);
  }
}

/// Elements k of four of each row in vector k. `row(i)` points to the first of lane i's.
template <class V, class Row>
Fours<V> read_fours(const Row& row) {
  using Half = typename HalfOf<V>::Type;
  Fours<V> r;
  for (int j = 0; j < 4; ++j) r.v[j] = joined<V>(load<Half>(row(j)), load<Half>(row((j + 4) % kLanes)));
  return turned(r);
}

/// The same of three floats a row: nothing behind them is read.
template <class Row>
V3f read_threes(const Row& row) {
  const auto three = [&](int i) { return as<HalfOf<F32>::Type>(_mm_maskload_ps(row(i), _mm_setr_epi32(-1, -1, -1, 0))); };
  Fours<F32> r;
  for (int j = 0; j < 4; ++j) r.v[j] = joined<F32>(three(j), three((j + 4) % kLanes));
  const Fours<F32> columns = turned(r);
  return {columns.v[0], columns.v[1], columns.v[2]};
}

/// Row `lane` of what has been turned back.
template <class V>
typename HalfOf<V>::Type row_of(const Fours<V>& r, int lane) {
  const V& v = r.v[lane & 3];
  if constexpr (sizeof(V) == sizeof(typename HalfOf<V>::Type)) {
    return v;
  } else {
    return lane < 4 ? __builtin_shufflevector(v, v, 0, 1, 2, 3) : __builtin_shufflevector(v, v, 4, 5, 6, 7);
  }
}

inline std::uint32_t bits_of(I64 mask) {
#if defined(__AVX512DQ__)
  if constexpr (kLanes == 8) return _mm512_movepi64_mask(as<__m512i>(mask));
#endif
  if constexpr (kLanes == 4) return static_cast<std::uint32_t>(_mm256_movemask_pd(as<__m256d>(mask)));
}

}  // namespace
}  // namespace raykiln::render
