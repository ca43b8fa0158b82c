// Vectors of doubles, floats and integers as the compiler knows them, kLanes at a time; keyed random numbers and
// Sobol' points of as many vertices. For units with an instruction set of their own, which define kLanes
// first: everything has internal linkage. Each function does what its namesake for one number does, in
// the same order, so that no bit differs: see raykiln/sampling and raykiln/math.
#pragma once

#include <cstddef>
#include <cstdint>

namespace raykiln::render {
namespace {

using F64 = double __attribute__((vector_size(8 * kLanes)));
using I64 = std::int64_t __attribute__((vector_size(8 * kLanes)));
using U64 = std::uint64_t __attribute__((vector_size(8 * kLanes)));
using F32 = float __attribute__((vector_size(4 * kLanes)));
using I32 = std::int32_t __attribute__((vector_size(4 * kLanes)));
using U32 = std::uint32_t __attribute__((vector_size(4 * kLanes)));

/// Same bits, other type of the same size.
template <typename To, typename From>
To as(const From& v) {
  static_assert(sizeof(To) == sizeof(From));
  To to;
  __builtin_memcpy(&to, &v, sizeof(to));
  return to;
}
template <typename V, typename T>
V load(const T* p) {
  V v;
  __builtin_memcpy(&v, p, sizeof(v));
  return v;
}
template <typename V, typename T>
void store(T* p, const V& v) {
  __builtin_memcpy(p, &v, sizeof(v));
}

inline F64 wide(F32 v) { return __builtin_convertvector(v, F64); }
inline F32 narrow(F64 v) { return __builtin_convertvector(v, F32); }
inline F64 all(double v) { return v - F64{}; }

inline F64 select(I64 m, F64 a, F64 b) { return m ? a : b; }
inline F64 absolute(F64 v) { return as<F64>(as<U64>(v) & 0x7FFFFFFFFFFFFFFFU); }
/// std::max and std::min, NaN and zeros as there.
inline F64 larger(F64 a, F64 b) { return a < b ? b : a; }
inline F64 smaller(F64 a, F64 b) { return b < a ? b : a; }

inline F64 root(F64 v) {
#if defined(__AVX512F__)
  if constexpr (kLanes == 8) return as<F64>(_mm512_sqrt_pd(as<__m512d>(v)));
#endif
  if constexpr (kLanes == 4) return as<F64>(_mm256_sqrt_pd(as<__m256d>(v)));
}

struct V3 {
  F64 x, y, z;
};
inline V3 operator+(const V3& a, const V3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline V3 operator-(const V3& a, const V3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline V3 operator*(const V3& a, const V3& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
inline V3 operator*(F64 s, const V3& a) { return {s * a.x, s * a.y, s * a.z}; }
inline V3 operator/(const V3& a, F64 s) { return {a.x / s, a.y / s, a.z / s}; }
inline F64 dot(const V3& a, const V3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline V3 cross(const V3& a, const V3& b) {
  return {a.y * b.z - b.y * a.z, a.z * b.x - b.z * a.x, a.x * b.y - b.x * a.y};
}
inline V3 absolute(const V3& a) { return {absolute(a.x), absolute(a.y), absolute(a.z)}; }
inline F64 largest(const V3& a) { return larger(larger(a.x, a.y), a.z); }
inline I64 is_zero(const V3& a) { return (a.x == 0.0) & (a.y == 0.0) & (a.z == 0.0); }
inline V3 select(I64 m, const V3& a, const V3& b) {
  return {select(m, a.x, b.x), select(m, a.y, b.y), select(m, a.z, b.z)};
}

struct V3f {
  F32 x, y, z;
};
inline V3 wide(const V3f& a) { return {wide(a.x), wide(a.y), wide(a.z)}; }
inline V3f narrow(const V3& a) { return {narrow(a.x), narrow(a.y), narrow(a.z)}; }
inline V3f operator-(const V3f& a, const V3f& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }

/// An integer below 2^53 as a double: where the processor does not know it, both halves are joined with exponents of
/// their own.
inline F64 as_double(U64 v) {
#if defined(__AVX512DQ__)
  return __builtin_convertvector(v, F64);
#endif
  const F64 high = as<F64>((v >> 32) | 0x4530000000000000U);            // 2^84 + high 2^32
  const F64 low = as<F64>((v & 0xFFFFFFFFU) | 0x4330000000000000U);     // 2^52 + low
  return (high - 0x1.00000001p84) + low;
}

constexpr std::uint64_t kGolden = 0x9E3779B97F4A7C15U;
constexpr std::uint64_t kRootTwo = 0x6A09E667F3BCC909U;

inline U64 mix(U64 z, U64 word) {
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9U;
  z += word;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBU;
  return z ^ (z >> 31);
}

struct Keys {
  U64 a, b;
  U32 reversed_index;
};

inline Keys vertex_keys(U64 a, U64 b, U64 point, U64 node, U64 bounce) {
  const U64 n = mix(b + node * kGolden, bounce * kRootTwo);
  return {mix(a + bounce * kGolden, n), mix(n + kRootTwo, a), __builtin_convertvector(point, U32)};
}

inline F64 plain_number(const Keys& key, std::uint64_t slot) {
  return as_double(mix(key.a + (slot + 1) * kGolden, key.b) >> 11) * 0x1p-53;
}

/// Bytes in the other order, then both halves of each by a table.
inline U32 reversed(U32 x) {
  constexpr char kTurned[16] = {0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15};
  constexpr char kBytes[16] = {3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12};
  const __m128i turned = load<__m128i>(kTurned), bytes = load<__m128i>(kBytes);
  const U32 low = x & 0x0F0F0F0FU, high = (x >> 4) & 0x0F0F0F0FU;
  if constexpr (kLanes == 8) {
    const auto table = _mm256_broadcastsi128_si256(turned);
    const U32 whole = (as<U32>(_mm256_shuffle_epi8(table, as<__m256i>(low))) << 4) |
                      as<U32>(_mm256_shuffle_epi8(table, as<__m256i>(high)));
    return as<U32>(_mm256_shuffle_epi8(as<__m256i>(whole), _mm256_broadcastsi128_si256(bytes)));
  }
  if constexpr (kLanes == 4) {
    const U32 whole = (as<U32>(_mm_shuffle_epi8(turned, as<__m128i>(low))) << 4) |
                      as<U32>(_mm_shuffle_epi8(turned, as<__m128i>(high)));
    return as<U32>(_mm_shuffle_epi8(as<__m128i>(whole), bytes));
  }
}
inline U32 scrambled(U32 x, U32 seed) {
  x ^= x * 0x3D20ADEAU;
  x += seed;
  x *= (seed >> 16) | 1U;
  x ^= x * 0x05526C56U;
  x ^= x * 0x53A22864U;
  return x;
}
inline U32 pascal_product(U32 x) {
  x ^= (x >> 1) & 0x55555555U;
  x ^= (x >> 2) & 0x33333333U;
  x ^= (x >> 4) & 0x0F0F0F0FU;
  x ^= (x >> 8) & 0x00FF00FFU;
  return x ^ (x >> 16);
}
/// `of_digits`: sobol::Columns, 16 words for each four digits of the index.
inline U32 product(const std::uint32_t* of_digits, U32 index) {
  U32 x{};
  for (int i = 0; i < 8; ++i) {
    const auto first = load<__m256i>(of_digits + 16 * i), second = load<__m256i>(of_digits + 16 * i + 8);
    const U32 digits = index >> (4 * i);
#if defined(__AVX512VL__)
    if constexpr (kLanes == 8) x ^= as<U32>(_mm256_permutex2var_epi32(first, as<__m256i>(digits), second));
#endif
    if constexpr (kLanes == 4) {
      const __m256i three = _mm256_castsi128_si256(as<__m128i>(digits));
      const auto below = _mm256_castsi256_si128(_mm256_permutevar8x32_epi32(first, three));
      const auto above = _mm256_castsi256_si128(_mm256_permutevar8x32_epi32(second, three));
      x ^= as<U32>(_mm_blendv_ps(as<__m128>(below), as<__m128>(above), as<__m128>(index << (28 - 4 * i))));
    }
  }
  return x;
}

/// Four slots of a vertex that are coordinates of one point.
struct SobolGroup {
  U64 group;
  U32 index;
};
template <typename Group>
SobolGroup sobol_group(const Keys& key, Group group) {
  const U64 word = mix(key.a + (17 + group) * kGolden, key.b);
  return {word, reversed(scrambled(key.reversed_index, __builtin_convertvector(word, U32)))};
}
/// `coordinate`: that of the point of g.index in `dimension`.
inline F64 sobol_number(const SobolGroup& g, std::uint64_t dimension, U32 coordinate) {
  const U64 own = mix(g.group + (dimension + 1) * kGolden, U64{} + kRootTwo);
  const U64 digits = __builtin_convertvector(
      reversed(scrambled(coordinate, __builtin_convertvector(own >> 32, U32))), U64);
  const U64 further = ((digits ^ own) * kGolden) >> 43;
  return as_double((digits << 21) | further) * 0x1p-53;
}

struct Pair {
  F64 u, v;
};
/// The two numbers of slots that have the first two dimensions of `group`.
inline Pair first_pair(bool sobol, const Keys& key, std::uint64_t group, std::uint64_t slot_u) {
  if (!sobol) return {plain_number(key, slot_u), plain_number(key, slot_u + 1)};
  const SobolGroup g = sobol_group(key, group);
  return {sobol_number(g, 0, g.index), sobol_number(g, 1, pascal_product(g.index))};
}
/// Those of slots that have the last two.
inline Pair last_pair(bool sobol, const Keys& key, std::uint64_t group, std::uint64_t slot_u, const std::uint32_t* of_digits) {
  if (!sobol) return {plain_number(key, slot_u), plain_number(key, slot_u + 1)};
  const SobolGroup g = sobol_group(key, group);
  const U32 third = product(of_digits, g.index);
  return {sobol_number(g, 2, third), sobol_number(g, 3, pascal_product(third))};
}
/// The number of a slot that has the third. `group`: of all lanes, or of each.
template <typename Group>
F64 third_of(bool sobol, const Keys& key, Group group, std::uint64_t slot, const std::uint32_t* of_digits) {
  if (!sobol) return plain_number(key, slot);
  const SobolGroup g = sobol_group(key, group);
  return sobol_number(g, 2, product(of_digits, g.index));
}

}  // namespace
}  // namespace raykiln::render
