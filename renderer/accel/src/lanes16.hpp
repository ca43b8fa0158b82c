// Sixteen lanes in AVX-512 registers. For units with their own instruction set only: everything has
// internal linkage.
#pragma once

#include <immintrin.h>

#include <cstdint>

namespace raykiln::render {
namespace {

/// Eight lanes in double.
struct Doubles8 {
  static constexpr std::uint32_t kWidth = 8;
  using F = __m512d;

  static F load(const float* p) { return _mm512_cvtps_pd(_mm256_load_ps(p)); }
  static F load(const double* p) { return _mm512_load_pd(p); }
  static F set1(double v) { return _mm512_set1_pd(v); }
  static void store(float* p, F v) { _mm256_store_ps(p, _mm512_cvtpd_ps(v)); }
  static F round_to_float(F v) { return _mm512_cvtps_pd(_mm512_cvtpd_ps(v)); }
  static F add(F a, F b) { return _mm512_add_pd(a, b); }
  static F sub(F a, F b) { return _mm512_sub_pd(a, b); }
  static F mul(F a, F b) { return _mm512_mul_pd(a, b); }
  static F div(F a, F b) { return _mm512_div_pd(a, b); }
  static F min(F a, F b) { return _mm512_min_pd(a, b); }
  static F max(F a, F b) { return _mm512_max_pd(a, b); }
  static F abs(F a) { return _mm512_abs_pd(a); }
  static std::uint32_t lt(F a, F b) { return _mm512_cmp_pd_mask(a, b, _CMP_LT_OQ); }
  static std::uint32_t le(F a, F b) { return _mm512_cmp_pd_mask(a, b, _CMP_LE_OQ); }
  static std::uint32_t eq(F a, F b) { return _mm512_cmp_pd_mask(a, b, _CMP_EQ_OQ); }
};

struct Lanes16 {
  static constexpr std::uint32_t kWidth = 16;
  static constexpr bool kFetchesMore = true;   ///< of leaves and rays, see fetch_leaf
  static constexpr bool kGoesOn = true;  ///< past the edge functions of a block, see LeafVisit
  static constexpr std::uint64_t kCachedNodes = 16384;  ///< of a tree that is walked as if caches held all of it
  using F = __m512;
  using I = __m512i;
  using M = __mmask16;

  static F load(const float* p) { return _mm512_load_ps(p); }
  static I load(const std::uint32_t* p) { return _mm512_load_si512(p); }
  static void store(float* p, F v) { _mm512_store_ps(p, v); }
  static void store(std::uint32_t* p, I v) { _mm512_store_si512(p, v); }
  /// a / b of every lane, in double.
  static void store_quotients(double* p, F a, F b) {
    const auto eight = [](F v, int half) {
      return _mm512_cvtps_pd(half == 0 ? _mm512_castps512_ps256(v) : _mm512_extractf32x8_ps(v, 1));
    };
    _mm512_store_pd(p, _mm512_div_pd(eight(a, 0), eight(b, 0)));
    _mm512_store_pd(p + 8, _mm512_div_pd(eight(a, 1), eight(b, 1)));
  }
  static F set1(float v) { return _mm512_set1_ps(v); }
  static I set1(std::uint32_t v) { return _mm512_set1_epi32(static_cast<int>(v)); }

  static F add(F a, F b) { return _mm512_add_ps(a, b); }
  static F sub(F a, F b) { return _mm512_sub_ps(a, b); }
  static F mul(F a, F b) { return _mm512_mul_ps(a, b); }
  static F div(F a, F b) { return _mm512_div_ps(a, b); }
  /// a b + c, a b - c and c - a b, rounded once.
  static F mul_add(F a, F b, F c) { return _mm512_fmadd_ps(a, b, c); }
  static F mul_sub(F a, F b, F c) { return _mm512_fmsub_ps(a, b, c); }
  static F sub_mul(F c, F a, F b) { return _mm512_fnmadd_ps(a, b, c); }
  /// a < b ? a : b, so b if one is NaN.
  static F min(F a, F b) { return _mm512_min_ps(a, b); }
  /// a > b ? a : b, so b if one is NaN.
  static F max(F a, F b) { return _mm512_max_ps(a, b); }
  static F abs(F a) { return _mm512_abs_ps(a); }
  /// The larger of |a| and |b|; of a number and NaN the number.
  static F larger_magnitude(F a, F b) { return _mm512_range_ps(a, b, 0xB); }
  /// a with its sign turned where b is negative.
  static F turn_sign(F a, F b) { return _mm512_xor_ps(a, _mm512_and_ps(b, set1(-0.0F))); }

  static M lt(F a, F b) { return _mm512_cmp_ps_mask(a, b, _CMP_LT_OQ); }
  static M le(F a, F b) { return _mm512_cmp_ps_mask(a, b, _CMP_LE_OQ); }
  static M not_gt(F a, F b) { return _mm512_cmp_ps_mask(a, b, _CMP_NGT_UQ); }
  static M eq(I a, I b) { return _mm512_cmpeq_epi32_mask(a, b); }
  static M both(M a, M b) { return _kand_mask16(a, b); }
  static M either(M a, M b) { return _kor_mask16(a, b); }
  static M not_but(M a, M b) { return _kandn_mask16(a, b); }  ///< b without a
  static std::uint32_t bits(M m) { return _cvtmask16_u32(m); }

  /// m ? b : a
  static F blend(M m, F a, F b) { return _mm512_mask_blend_ps(m, a, b); }
  static I blend(M m, I a, I b) { return _mm512_mask_blend_epi32(m, a, b); }
  static I add(I a, I b) { return _mm512_add_epi32(a, b); }
  static I add_where(M m, I a, I b) { return _mm512_mask_add_epi32(a, m, a, b); }
  static I both(I a, I b) { return _mm512_and_si512(a, b); }
  static I flip(I a, I b) { return _mm512_xor_si512(a, b); }
  template <int kBits>
  static I shift_right(I a) {
    return _mm512_srli_epi32(a, kBits);
  }
  static I as_int(F a) { return _mm512_castps_si512(a); }
  static F as_float(I a) { return _mm512_castsi512_ps(a); }

  /// x, y or z by an axis of 0, 1 or 2 in each lane.
  static F select(I axis, F x, F y, F z) {
    const F xz = blend(eq(axis, _mm512_setzero_si512()), z, x);
    return blend(eq(axis, set1(1U)), xz, y);
  }

  /// The two words of nodes[index[lane]]. Plain loads: gathers are slow on many processors.
  static void load_nodes(const void* nodes, const std::uint32_t* index, I& first, I& second) {
    const auto* base = static_cast<const double*>(nodes);
    const auto pair = [&](int a) {
      return _mm_loadh_pd(_mm_load_sd(base + index[a]), base + index[a + 1]);
    };
    const auto eight = [&](int a, int b) {
      const __m256d lo = _mm256_set_m128d(pair(a + 4), pair(a));
      const __m256d hi = _mm256_set_m128d(pair(b + 4), pair(b));
      return _mm512_castpd_ps(_mm512_insertf64x4(_mm512_castpd256_pd512(lo), hi, 1));
    };
    const F even = eight(0, 8);
    const F odd = eight(2, 10);
    first = as_int(_mm512_shuffle_ps(even, odd, 0x88));
    second = as_int(_mm512_shuffle_ps(even, odd, 0xDD));
  }

  /// Eight floats from each of the rows; out[k] holds number k of every row.
  static void transpose(const float* const* rows, float (*out)[kWidth]) {
    for (int half = 0; half < 8; half += 4) {
      const auto four = [&](int i) {
        const auto part = [&](int row) { return _mm_loadu_ps(rows[row] + half); };
        F v = _mm512_castps128_ps512(part(i));
        v = _mm512_insertf32x4(v, part(i + 4), 1);
        v = _mm512_insertf32x4(v, part(i + 8), 2);
        return _mm512_insertf32x4(v, part(i + 12), 3);
      };
      const F rows0 = four(0), rows1 = four(1), rows2 = four(2), rows3 = four(3);
      const F lo01 = _mm512_unpacklo_ps(rows0, rows1);
      const F lo23 = _mm512_unpacklo_ps(rows2, rows3);
      const F hi01 = _mm512_unpackhi_ps(rows0, rows1);
      const F hi23 = _mm512_unpackhi_ps(rows2, rows3);
      store(out[half], _mm512_shuffle_ps(lo01, lo23, 0x44));
      store(out[half + 1], _mm512_shuffle_ps(lo01, lo23, 0xEE));
      store(out[half + 2], _mm512_shuffle_ps(hi01, hi23, 0x44));
      store(out[half + 3], _mm512_shuffle_ps(hi01, hi23, 0xEE));
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
    const __m512 a_f = as_float(a);
    const __m512 ab_lo = _mm512_unpacklo_ps(a_f, b);
    const __m512 ab_hi = _mm512_unpackhi_ps(a_f, b);
    const __m512 c_lo = _mm512_unpacklo_ps(c, c);
    const __m512 c_hi = _mm512_unpackhi_ps(c, c);
    const auto put = [&](std::uint32_t lane, __m512 four) {
      const auto at = [&](std::uint32_t l) {
        return reinterpret_cast<float*>(base + l * stride + offset[l]);
      };
      _mm_store_ps(at(lane), _mm512_castps512_ps128(four));
      _mm_store_ps(at(lane + 4), _mm512_extractf32x4_ps(four, 1));
      _mm_store_ps(at(lane + 8), _mm512_extractf32x4_ps(four, 2));
      _mm_store_ps(at(lane + 12), _mm512_extractf32x4_ps(four, 3));
    };
    put(0, _mm512_shuffle_ps(ab_lo, c_lo, 0x44));
    put(1, _mm512_shuffle_ps(ab_lo, c_lo, 0xEE));
    put(2, _mm512_shuffle_ps(ab_hi, c_hi, 0x44));
    put(3, _mm512_shuffle_ps(ab_hi, c_hi, 0xEE));
  }
};

/// Two neighbouring blocks of eight triangles.
struct Lanes8Twice : Lanes16 {
  static constexpr std::size_t kBlockBytes = 320;

  static F load(const float* p) {
    const auto* second = reinterpret_cast<const unsigned char*>(p) + kBlockBytes;
    return _mm512_insertf32x8(_mm512_castps256_ps512(_mm256_load_ps(p)),
                              _mm256_load_ps(reinterpret_cast<const float*>(second)), 1);
  }
  static I load(const std::uint32_t* p) {
    return as_int(load(reinterpret_cast<const float*>(p)));
  }
};

}  // namespace
}  // namespace raykiln::render
