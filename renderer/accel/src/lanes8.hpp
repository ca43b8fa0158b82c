// Eight lanes in AVX2 registers. For units with their own instruction set only: everything has
// internal linkage.
#pragma once

#include <immintrin.h>

#include <cstdint>

namespace raykiln::render {
namespace {

/// Four lanes in double.
struct Doubles4 {
  static constexpr std::uint32_t kWidth = 4;
  using F = __m256d;

  static F load(const float* p) { return _mm256_cvtps_pd(_mm_load_ps(p)); }
  static F load(const double* p) { return _mm256_load_pd(p); }
  static F set1(double v) { return _mm256_set1_pd(v); }
  static void store(float* p, F v) { _mm_store_ps(p, _mm256_cvtpd_ps(v)); }
  static F round_to_float(F v) { return _mm256_cvtps_pd(_mm256_cvtpd_ps(v)); }
  static F add(F a, F b) { return _mm256_add_pd(a, b); }
  static F sub(F a, F b) { return _mm256_sub_pd(a, b); }
  static F mul(F a, F b) { return _mm256_mul_pd(a, b); }
  static F div(F a, F b) { return _mm256_div_pd(a, b); }
  static F min(F a, F b) { return _mm256_min_pd(a, b); }
  static F max(F a, F b) { return _mm256_max_pd(a, b); }
  static F abs(F a) { return _mm256_andnot_pd(set1(-0.0), a); }
  static std::uint32_t lt(F a, F b) { return bits(_mm256_cmp_pd(a, b, _CMP_LT_OQ)); }
  static std::uint32_t le(F a, F b) { return bits(_mm256_cmp_pd(a, b, _CMP_LE_OQ)); }
  static std::uint32_t eq(F a, F b) { return bits(_mm256_cmp_pd(a, b, _CMP_EQ_OQ)); }

 private:
  static std::uint32_t bits(F m) { return static_cast<std::uint32_t>(_mm256_movemask_pd(m)); }
};

struct Lanes8 {
  static constexpr std::uint32_t kWidth = 8;
  static constexpr bool kFetchesMore = false;  ///< not measured; gated instructions would rise
  static constexpr bool kGoesOn = false;  ///< past the edge functions of a block, see LeafVisit
  static constexpr std::uint64_t kCachedNodes = 8192;  ///< of a tree that is walked as if caches held all of it
  using F = __m256;
  using I = __m256i;
  using M = __m256;  ///< all bits of a lane, or none

  static F load(const float* p) { return _mm256_load_ps(p); }
  static I load(const std::uint32_t* p) {
    return _mm256_load_si256(reinterpret_cast<const __m256i*>(p));
  }
  static void store(float* p, F v) { _mm256_store_ps(p, v); }
  static void store(std::uint32_t* p, I v) {
    _mm256_store_si256(reinterpret_cast<__m256i*>(p), v);
  }
  /// a / b of every lane, in double.
  static void store_quotients(double* p, F a, F b) {
    const auto four = [](F v, int half) {
      return _mm256_cvtps_pd(half == 0 ? _mm256_castps256_ps128(v) : _mm256_extractf128_ps(v, 1));
    };
    _mm256_store_pd(p, _mm256_div_pd(four(a, 0), four(b, 0)));
    _mm256_store_pd(p + 4, _mm256_div_pd(four(a, 1), four(b, 1)));
  }
  static F set1(float v) { return _mm256_set1_ps(v); }
  static I set1(std::uint32_t v) { return _mm256_set1_epi32(static_cast<int>(v)); }

  static F add(F a, F b) { return _mm256_add_ps(a, b); }
  static F sub(F a, F b) { return _mm256_sub_ps(a, b); }
  static F mul(F a, F b) { return _mm256_mul_ps(a, b); }
  static F div(F a, F b) { return _mm256_div_ps(a, b); }
  /// a b + c, a b - c and c - a b, rounded once.
  static F mul_add(F a, F b, F c) { return _mm256_fmadd_ps(a, b, c); }
  static F mul_sub(F a, F b, F c) { return _mm256_fmsub_ps(a, b, c); }
  static F sub_mul(F c, F a, F b) { return _mm256_fnmadd_ps(a, b, c); }
  /// a < b ? a : b, so b if one is NaN.
  static F min(F a, F b) { return _mm256_min_ps(a, b); }
  /// a > b ? a : b, so b if one is NaN.
  static F max(F a, F b) { return _mm256_max_ps(a, b); }
  static F abs(F a) { return _mm256_andnot_ps(set1(-0.0F), a); }
  /// The larger of |a| and |b|.
  static F larger_magnitude(F a, F b) {
#ifdef __AVX512DQ__
    return _mm256_range_ps(a, b, 0xB);
#else
    return max(abs(a), abs(b));
#endif
  }
  /// a with its sign turned where b is negative.
  static F turn_sign(F a, F b) { return _mm256_xor_ps(a, _mm256_and_ps(b, set1(-0.0F))); }

  static M lt(F a, F b) { return _mm256_cmp_ps(a, b, _CMP_LT_OQ); }
  static M le(F a, F b) { return _mm256_cmp_ps(a, b, _CMP_LE_OQ); }
  static M not_gt(F a, F b) { return _mm256_cmp_ps(a, b, _CMP_NGT_UQ); }
  static M eq(I a, I b) { return _mm256_castsi256_ps(_mm256_cmpeq_epi32(a, b)); }
  static M both(M a, M b) { return _mm256_and_ps(a, b); }
  static M either(M a, M b) { return _mm256_or_ps(a, b); }
  static M not_but(M a, M b) { return _mm256_andnot_ps(a, b); }  ///< b without a
  static std::uint32_t bits(M m) { return static_cast<std::uint32_t>(_mm256_movemask_ps(m)); }

  /// m ? b : a
  static F blend(M m, F a, F b) { return _mm256_blendv_ps(a, b, m); }
  static I blend(M m, I a, I b) {
    return _mm256_castps_si256(
        _mm256_blendv_ps(_mm256_castsi256_ps(a), _mm256_castsi256_ps(b), m));
  }
  static I add(I a, I b) { return _mm256_add_epi32(a, b); }
  static I add_where(M m, I a, I b) { return add(a, _mm256_and_si256(_mm256_castps_si256(m), b)); }
  static I both(I a, I b) { return _mm256_and_si256(a, b); }
  static I flip(I a, I b) { return _mm256_xor_si256(a, b); }
  template <int kBits>
  static I shift_right(I a) {
    return _mm256_srli_epi32(a, kBits);
  }
  static I as_int(F a) { return _mm256_castps_si256(a); }
  static F as_float(I a) { return _mm256_castsi256_ps(a); }

  /// x, y or z by an axis of 0, 1 or 2 in each lane.
  static F select(I axis, F x, F y, F z) {
    const F is_x = eq(axis, _mm256_setzero_si256());
    const F is_y = eq(axis, set1(1U));
    const F rest = _mm256_andnot_ps(_mm256_or_ps(is_x, is_y), z);
    return _mm256_or_ps(rest, _mm256_or_ps(_mm256_and_ps(is_x, x), _mm256_and_ps(is_y, y)));
  }

  /// The two words of nodes[index[lane]]. Plain loads: gathers are slow on many processors.
  static void load_nodes(const void* nodes, const std::uint32_t* index, I& first, I& second) {
    const auto* base = static_cast<const double*>(nodes);
    const auto pair = [&](int a, int b) {
      return _mm_loadh_pd(_mm_load_sd(base + index[a]), base + index[b]);
    };
    const __m256 lo = _mm256_castpd_ps(_mm256_set_m128d(pair(4, 5), pair(0, 1)));
    const __m256 hi = _mm256_castpd_ps(_mm256_set_m128d(pair(6, 7), pair(2, 3)));
    first = as_int(_mm256_shuffle_ps(lo, hi, 0x88));
    second = as_int(_mm256_shuffle_ps(lo, hi, 0xDD));
  }

  /// Eight floats from each of the rows; out[k] holds number k of every row.
  static void transpose(const float* const* rows, float (*out)[kWidth]) {
    for (int half = 0; half < 8; half += 4) {
      const auto two = [&](int i) {
        return _mm256_set_m128(_mm_loadu_ps(rows[i + 4] + half), _mm_loadu_ps(rows[i] + half));
      };
      const F rows0 = two(0), rows1 = two(1), rows2 = two(2), rows3 = two(3);
      const F lo01 = _mm256_unpacklo_ps(rows0, rows1);
      const F lo23 = _mm256_unpacklo_ps(rows2, rows3);
      const F hi01 = _mm256_unpackhi_ps(rows0, rows1);
      const F hi23 = _mm256_unpackhi_ps(rows2, rows3);
      store(out[half], _mm256_shuffle_ps(lo01, lo23, 0x44));
      store(out[half + 1], _mm256_shuffle_ps(lo01, lo23, 0xEE));
      store(out[half + 2], _mm256_shuffle_ps(hi01, hi23, 0x44));
      store(out[half + 3], _mm256_shuffle_ps(hi01, hi23, 0xEE));
    }
  }

  static void prefetch_nodes(const void* nodes, const std::uint32_t* index) {
    for (std::uint32_t lane = 0; lane < kWidth; ++lane) {
      __builtin_prefetch(static_cast<const double*>(nodes) + index[lane]);
    }
  }

  /// (a, b, c) of every lane as 16 bytes at base + lane * stride + offset[lane].
  static void store_entries(unsigned char* base, std::size_t stride, const std::uint32_t* offset,
                            I a, F b, F c) {
    const __m256 a_f = as_float(a);
    const __m256 ab_lo = _mm256_unpacklo_ps(a_f, b);
    const __m256 ab_hi = _mm256_unpackhi_ps(a_f, b);
    const __m256 c_lo = _mm256_unpacklo_ps(c, c);
    const __m256 c_hi = _mm256_unpackhi_ps(c, c);
    const auto put = [&](std::uint32_t lane, __m256 two) {
      const auto at = [&](std::uint32_t l) {
        return reinterpret_cast<float*>(base + l * stride + offset[l]);
      };
      _mm_store_ps(at(lane), _mm256_castps256_ps128(two));
      _mm_store_ps(at(lane + 4), _mm256_extractf128_ps(two, 1));
    };
    put(0, _mm256_shuffle_ps(ab_lo, c_lo, 0x44));
    put(1, _mm256_shuffle_ps(ab_lo, c_lo, 0xEE));
    put(2, _mm256_shuffle_ps(ab_hi, c_hi, 0x44));
    put(3, _mm256_shuffle_ps(ab_hi, c_hi, 0xEE));
  }
};

}  // namespace
}  // namespace raykiln::render
