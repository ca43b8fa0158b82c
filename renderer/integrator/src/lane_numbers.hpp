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

/// An integer below 2^53 as a double: both halves are joined with exponents of their own.
inline F64 as_double(U64 v) {
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

inline U32 reversed(U32 x) {
  x = ((x >> 1) & 0x55555555U) | ((x & 0x55555555U) << 1);
  x = ((x >> 2) & 0x33333333U) | ((x & 0x33333333U) << 2);
  x = ((x >> 4) & 0x0F0F0F0FU) | ((x & 0x0F0F0F0FU) << 4);
  x = ((x >> 8) & 0x00FF00FFU) | ((x & 0x00FF00FFU) << 8);
  return (x >> 16) | (x << 16);
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
inline U32 product(const std::uint32_t* columns, U32 index) {
  U32 x{};
  for (unsigned j = 0; j < 32; ++j) x ^= (0U - ((index >> j) & 1U)) & columns[j];
  return x;
}

/// Four slots of a vertex that are coordinates of one point.
struct SobolGroup {
  U64 group;
  U32 index;
};
inline SobolGroup sobol_group(const Keys& key, std::uint64_t group) {
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

/// The two numbers of slots that have the first two dimensions of `group`.
struct Pair {
  F64 u, v;
};
inline Pair pair_of(bool sobol, const Keys& key, std::uint64_t group, std::uint64_t slot_u) {
  if (!sobol) return {plain_number(key, slot_u), plain_number(key, slot_u + 1)};
  const SobolGroup g = sobol_group(key, group);
  return {sobol_number(g, 0, g.index), sobol_number(g, 1, pascal_product(g.index))};
}
/// The number of a slot that has the third.
inline F64 third_of(bool sobol, const Keys& key, std::uint64_t slot, const std::uint32_t* columns) {
  if (!sobol) return plain_number(key, slot);
  const SobolGroup g = sobol_group(key, slot / 4);
  return sobol_number(g, 2, product(columns, g.index));
}

}  // namespace
}  // namespace raykiln::render
