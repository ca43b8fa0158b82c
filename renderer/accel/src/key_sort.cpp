#include "key_sort.hpp"

#include <algorithm>
#include <array>

namespace raykiln::render {
namespace {

constexpr unsigned kMaxDigitBits = 12;
constexpr std::size_t kInsertionMax = 32;
using Histogram = std::array<std::uint32_t, 1U << kMaxDigitBits>;

struct Digit {
  unsigned shift;
  unsigned bits;
  [[nodiscard]] std::size_t of(std::uint64_t key) const {
    return static_cast<std::size_t>(key >> shift) & ((std::size_t{1} << bits) - 1);
  }
  [[nodiscard]] std::size_t buckets() const { return std::size_t{1} << bits; }
};

// Fills `histogram` with the first place of each bucket. False when all keys share one bucket.
bool bucket_starts(std::span<const std::uint64_t> keys, Digit digit, Histogram& histogram) {
  std::fill_n(histogram.begin(), digit.buckets(), 0U);
  for (const std::uint64_t key : keys) ++histogram[digit.of(key)];
  if (histogram[digit.of(keys[0])] == keys.size()) return false;
  std::uint32_t start = 0;
  for (std::size_t b = 0; b < digit.buckets(); ++b) {
    const std::uint32_t count = histogram[b];
    histogram[b] = start;
    start += count;
  }
  return true;
}

// Most calls are for a handful of keys.
std::uint64_t insertion_sort(std::span<std::uint64_t> keys) {
  std::uint64_t comparisons = 0;
  for (std::size_t i = 1; i < keys.size(); ++i) {
    const std::uint64_t key = keys[i];
    std::size_t to = i;
    for (; to > 0 && keys[to - 1] > key; --to) keys[to] = keys[to - 1];
    keys[to] = key;
    comparisons += i - to + 1;
  }
  return comparisons;
}

std::uint64_t comparison_sort(std::span<std::uint64_t> keys) {
  if (keys.size() <= kInsertionMax) return insertion_sort(keys);
  std::uint64_t comparisons = 0;
  std::sort(keys.begin(), keys.end(), [&comparisons](std::uint64_t a, std::uint64_t b) {
    ++comparisons;
    return a < b;
  });
  return comparisons;
}

}  // namespace

std::uint64_t sort_keys(std::span<std::uint64_t> keys, unsigned low_bit,
                        std::vector<std::uint64_t>& scratch, BuildContext* context) {
  if (keys.size() < kRadixSortMin) return comparison_sort(keys);
  if (scratch.size() < keys.size()) scratch.resize(keys.size());
  const unsigned bits = 64 - low_bit;
  const unsigned widest = keys.size() < 8192 ? 8 : kMaxDigitBits;  // a histogram must stay small
  const unsigned passes = (bits + widest - 1) / widest;
  const unsigned width = (bits + passes - 1) / passes;

  Histogram histogram;  // filled by bucket_starts
  std::span<std::uint64_t> from = keys;
  std::span<std::uint64_t> to(scratch.data(), keys.size());
  std::uint64_t moved = 0;
  for (unsigned shift = low_bit; shift < 64; shift += width) {
    if (context != nullptr && context->stopped()) break;
    const Digit digit{shift, std::min(width, 64 - shift)};
    moved += keys.size();
    if (!bucket_starts(from, digit, histogram)) continue;
    for (const std::uint64_t key : from) to[histogram[digit.of(key)]++] = key;
    std::swap(from, to);
  }
  if (from.data() != keys.data()) std::copy(from.begin(), from.end(), keys.begin());
  return moved;
}

}  // namespace raykiln::render
