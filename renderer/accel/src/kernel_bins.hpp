// Larger cells: extents are counted in bins, the cost of the planes in each bin is bounded, and the
// extents of few bins are found again.
#pragma once

#include "build_kernel_lanes.hpp"

namespace raykiln::render {
namespace {

/// A reference in one or two vectors: lo.xyz and hi.xyz with a fourth lane each that is in no bin.
constexpr int kParts = 8 / kLanes;

struct ScaleLanes {
  Floats lo, hi, scale, last;
  Ints used;
};

inline ScaleLanes lanes_of(const BinScale& s) {
  float lo[8], hi[8], scale[8], last[8];
  std::int32_t used[8];
  for (int i = 0; i < 8; ++i) {
    lo[i] = s.lo[i % 4];
    hi[i] = s.hi[i % 4];
    scale[i] = s.scale[i % 4];
    last[i] = s.last[i % 4];
    used[i] = i % 4 == 3 ? 0 : -1;
  }
  return {lanes_at<Floats>(lo), lanes_at<Floats>(hi), lanes_at<Floats>(scale),
          lanes_at<Floats>(last), lanes_at<Ints>(used)};
}

// See BinGrid. What is not a number, in cells wider than floats, goes to the last bin.
inline Ints bins_of(const ScaleLanes& s, ReferenceWords words) {
  const Ints bits = lanes_at<Ints>(words) & s.used;  // an id would be subnormal, and slow
  const auto x = lanes_at<Floats>(&bits);
  Floats t = (x - s.lo) * s.scale;
  t = t < s.last ? t : s.last;
  return __builtin_convertvector(t, Ints) - (x > s.lo) - (x >= s.hi);  // true is -1
}

inline BinCode code_of(const ScaleLanes& s, ReferenceWords words) {
#if defined(__AVX2__)
  const Ints bins = bins_of(s, words);
  const auto all = lanes_at<__m256i>(&bins);
  const __m128i packed = _mm_packs_epi32(_mm256_castsi256_si128(all), _mm256_extracti128_si256(all, 1));
  return static_cast<BinCode>(_mm_cvtsi128_si64(_mm_packus_epi16(packed, packed)));
#elif defined(__SSE2__)
  const Ints lo = bins_of(s, words);
  const Ints hi = bins_of(s, words + 4);
  const __m128i packed = _mm_packs_epi32(lanes_at<__m128i>(&lo), lanes_at<__m128i>(&hi));
  return static_cast<BinCode>(_mm_cvtsi128_si64(_mm_packus_epi16(packed, packed)));
#else
  BinCode code = 0;
  for (int part = 0; part < kParts; ++part) {
    const Ints bins = bins_of(s, words + kLanes * part);
    for (int i = 0; i < kLanes; ++i) {
      code |= static_cast<BinCode>(bins[i]) << (8 * (kLanes * part + i));
    }
  }
  return code;
#endif
}

void count_bins(const BinScale& scale, ReferenceWords references, std::size_t n, BinCode* codes,
                const BinTables& tables) {
  const ScaleLanes lanes = lanes_of(scale);
  const BinTables to = tables;
  for (std::size_t i = 0; i < n; ++i) {
    const BinCode code = code_of(lanes, references + 8 * i);
    codes[i] = code;
    ++to.starts[0][code & 0xFF];
    ++to.starts[1][code >> 8 & 0xFF];
    ++to.starts[2][code >> 16 & 0xFF];
    ++to.ends[0][code >> 32 & 0xFF];
    ++to.ends[1][code >> 40 & 0xFF];
    ++to.ends[2][code >> 48 & 0xFF];
  }
}

/// For each set of four codes, a bit each: how many there are, and which.
struct FoundLanes {
  std::uint16_t lane[16][4];
  std::uint8_t count[16];
};
constexpr FoundLanes found_lanes() {
  FoundLanes table{};
  for (unsigned set = 0; set < 16; ++set) {
    for (std::uint16_t lane = 0; lane < 4; ++lane) {
      if ((set >> lane & 1U) != 0) table.lane[set][table.count[set]++] = lane;
    }
  }
  return table;
}
constexpr FoundLanes kFoundLanes = found_lanes();

/// Which of four codes have a wanted byte.
struct WantedCodes {
  BinCode first, span, axes;

  [[nodiscard]] unsigned among(const BinCode* four) const {
#if defined(__AVX2__)
    const __m256i bins = _mm256_sub_epi8(lanes_at<__m256i>(four), _mm256_set1_epi64x(static_cast<long long>(first)));
    const __m256i within = _mm256_cmpeq_epi8(_mm256_min_epu8(bins, _mm256_set1_epi64x(static_cast<long long>(span))), bins);
    const __m256i hit = _mm256_and_si256(within, _mm256_set1_epi64x(static_cast<long long>(axes)));
    const __m256i none = _mm256_cmpeq_epi64(hit, _mm256_setzero_si256());
    return ~static_cast<unsigned>(_mm256_movemask_pd(_mm256_castsi256_pd(none))) & 15U;
#elif defined(__SSE2__)
    unsigned set = 0;
    for (int half = 0; half < 2; ++half) {
      const __m128i bins = _mm_sub_epi8(lanes_at<__m128i>(four + 2 * half), _mm_set1_epi64x(static_cast<long long>(first)));
      const __m128i within = _mm_cmpeq_epi8(_mm_min_epu8(bins, _mm_set1_epi64x(static_cast<long long>(span))), bins);
      const __m128i hit = _mm_and_si128(within, _mm_set1_epi64x(static_cast<long long>(axes)));
      const __m128i joined = _mm_or_si128(hit, _mm_slli_epi64(hit, 32));  // in the upper words
      const __m128i none = _mm_cmpeq_epi32(joined, _mm_setzero_si128());
      set |= (~static_cast<unsigned>(_mm_movemask_pd(_mm_castsi128_pd(none))) & 3U) << (2 * half);
    }
    return set;
#else
    unsigned set = 0;
    for (unsigned i = 0; i < 4; ++i) {
      for (unsigned shift = 0; shift < 64; shift += 8) {
        const bool used = (axes >> shift & 0xFF) != 0;
        const auto bin = static_cast<std::uint8_t>((four[i] >> shift) - (first >> shift));
        set |= used && bin <= (span >> shift & 0xFF) ? 1U << i : 0U;
      }
    }
    return set;
#endif
  }
};

std::size_t find_codes(const BinCode* codes, std::size_t n, BinCode first, BinCode span,
                       BinCode axes, std::uint16_t* found) {
  const WantedCodes wanted{first, span, axes};
  std::size_t size = 0;
  const auto add = [&](unsigned set, std::size_t at) {
    for (int i = 0; i < 4; ++i) {
      found[size + static_cast<std::size_t>(i)] = static_cast<std::uint16_t>(kFoundLanes.lane[set][i] + at);
    }
    size += kFoundLanes.count[set];
  };
  std::size_t at = 0;
  for (; at + 4 <= n; at += 4) add(wanted.among(codes + at), at);
  if (at < n) {
    BinCode rest[4]{};
    for (std::size_t i = at; i < n; ++i) rest[i - at] = codes[i];
    add(wanted.among(rest) & ((1U << (n - at)) - 1U), at);
  }
  return size;
}

// At least the triangles that begin before a bin are left of its planes and at most those that do not
// end before it right, and the cost is linear between its edges.
float bound_bins(const BinBoundsQuery& q, BinBounds& bounds) {
  bounds.n_left[0] = bounds.n_gone[0] = 0;
  for (std::size_t i = 0; i <= q.bins; ++i) {
    bounds.n_left[i + 1] = bounds.n_left[i] + static_cast<std::int32_t>(q.starts[i]);
    bounds.n_gone[i + 1] = bounds.n_gone[i] + static_cast<std::int32_t>(q.ends[i]);
  }
  const RoughCost& c = q.cost;
  const bool known = q.edges_known && c.usable;
  const auto n = static_cast<std::int32_t>(q.n);
  const float step = 1.0F / static_cast<float>(q.bins);
  // How much the cost can change within the uncertainty of an edge, and what floats cancel.
  const float slack = (c.cap + c.side) * (step * 0x1p-11F + 1e-6F) * static_cast<float>(q.n);
  Floats number;
  for (int i = 0; i < kLanes; ++i) number[i] = static_cast<float>(i);
  Floats lowest_most = all_of(kInfinite);
  for (std::size_t i = 1; i <= q.bins; i += kLanes) {
    const auto begun = lanes_at<Ints>(bounds.n_left + i), begun_behind = lanes_at<Ints>(bounds.n_left + i + 1);
    const auto gone = lanes_at<Ints>(bounds.n_gone + i), gone_behind = lanes_at<Ints>(bounds.n_gone + i + 1);
    const Ints holds = (begun != begun_behind) | (gone != gone_behind);
    if (!known) {
      const Floats unknown = holds ? Floats{} : all_of(kInfinite);
      __builtin_memcpy(bounds.least + i, &unknown, sizeof unknown);
      continue;
    }
    const Floats x = (static_cast<float>(i - 1) + number) * step;
    const Floats left = c.cap + c.side * x, left_behind = c.cap + c.side * (x + step);
    const Floats right = c.cap + c.side * (1.0F - x), right_behind = c.cap + c.side * (1.0F - (x + step));
    const Floats nl = __builtin_convertvector(begun, Floats);
    const Floats nl_most = __builtin_convertvector(begun_behind, Floats);
    const Floats nr = __builtin_convertvector(n - gone_behind, Floats);
    const Floats nr_most = __builtin_convertvector(n - gone, Floats);
    const Floats nl_nr = nl + nr, either = static_cast<float>(n) - nl_nr;  // on one side at least
    const Floats rest = either > 0.0F ? either : Floats{};
    const Floats a = left * nl + right * nr + (left < right ? left : right) * rest;
    const Floats b = left_behind * nl + right_behind * nr + (left_behind < right_behind ? left_behind : right_behind) * rest;
    const Floats a_most = left * nl_most + right * nr_most;
    const Floats b_most = left_behind * nl_most + right_behind * nr_most;
    Floats least = (c.step + (a < b ? a : b)) * (1.0F - kRoughSlack) - slack;
    const Ints may_be_empty = (begun == 0) | (gone_behind == n);
    least = may_be_empty ? least * c.empty_factor : least;
    least = holds ? least : all_of(kInfinite);
    __builtin_memcpy(bounds.least + i, &least, sizeof least);
    const Floats most = (c.step + (a_most > b_most ? a_most : b_most)) * (1.0F + kRoughSlack) + slack;
    const Ints counts = holds & (begun_behind - gone <= q.budget);
    const Floats most_if = counts ? most : all_of(kInfinite);
    lowest_most = most_if < lowest_most ? most_if : lowest_most;
  }
  return lowest(lowest_most);
}

}  // namespace
}  // namespace raykiln::render
