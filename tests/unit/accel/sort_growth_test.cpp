// The guarantee of the reference sort, by counted comparisons: n log n for every input, also one
// that an adversary makes up while the sort runs, and linear for equal keys.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <functional>
#include <numeric>
#include <vector>

#include "support/median_of_medians_sort.hpp"
#include "support/mesh_generators.hpp"

namespace raykiln::test {
namespace {

struct Effort {
  std::uint64_t comparisons = 0;
  int depth = 0;
};

Effort effort_of(std::vector<std::uint32_t> keys) {
  Effort effort;
  effort.depth = median_of_medians_sort(std::span(keys), [&](std::uint32_t a, std::uint32_t b) {
    ++effort.comparisons;
    return a < b;
  });
  EXPECT_TRUE(std::is_sorted(keys.begin(), keys.end()));
  return effort;
}

double per_n_lg_n(std::uint64_t comparisons, std::size_t n) {
  return static_cast<double>(comparisons) /
         (static_cast<double>(n) * std::log2(static_cast<double>(n)));
}

/// McIlroy 1999, "A Killer Adversary for Quicksort": keys get their values only when the sort
/// compares them, always so that the likely pivot turns out small.
class Adversary {
 public:
  explicit Adversary(std::size_t n) : value_(n, n), gas_(n) {}

  bool less(std::size_t a, std::size_t b) {
    ++comparisons;
    if (value_[a] == gas_ && value_[b] == gas_) value_[a == candidate_ ? a : b] = solid_++;
    if (value_[a] == gas_) {
      candidate_ = a;
    } else if (value_[b] == gas_) {
      candidate_ = b;
    }
    return value_[a] < value_[b];
  }
  std::uint64_t comparisons = 0;

 private:
  std::vector<std::size_t> value_;
  std::size_t gas_;
  std::size_t solid_ = 0;
  std::size_t candidate_ = 0;
};

// A textbook quicksort with the middle key as pivot: shows that the adversary bites.
void naive_quicksort(std::span<std::size_t> keys, Adversary& adversary) {
  while (keys.size() > 1) {
    std::swap(keys[0], keys[keys.size() / 2]);
    std::size_t end = 1;
    for (std::size_t i = 1; i < keys.size(); ++i) {
      if (adversary.less(keys[i], keys[0])) std::swap(keys[i], keys[end++]);
    }
    std::swap(keys[0], keys[end - 1]);
    auto low = keys.first(end - 1);
    auto high = keys.subspan(end);
    if (low.size() > high.size()) std::swap(low, high);
    naive_quicksort(low, adversary);
    keys = high;
  }
}

double adversary_effort(std::size_t n, bool naive) {
  Adversary adversary(n);
  std::vector<std::size_t> keys(n);
  std::iota(keys.begin(), keys.end(), std::size_t{0});
  if (naive) {
    naive_quicksort(keys, adversary);
  } else {
    median_of_medians_sort(std::span(keys), [&](std::size_t a, std::size_t b) {
      return adversary.less(a, b);
    });
  }
  return per_n_lg_n(adversary.comparisons, n);
}

TEST(SortGrowth, AdversaryCannotMakeItQuadratic) {
  for (const std::size_t n : {2000U, 4000U, 8000U, 16000U, 64000U}) {
    const double effort = adversary_effort(n, false);
    std::printf("adversary n = %zu: %.2f comparisons / (n lg n)\n", n, effort);
    EXPECT_LE(effort, 10.0);
  }
}

TEST(SortGrowth, AdversaryMakesTheTextbookQuicksortQuadratic) {
  EXPECT_GT(adversary_effort(8000, true), 3.5 * adversary_effort(1000, true));
}

TEST(SortGrowth, OrderedReversedAndRandomInputs) {
  for (const std::size_t n : {1U << 10, 1U << 14, 1U << 18}) {
    std::vector<std::uint32_t> keys(n);
    std::iota(keys.begin(), keys.end(), 0U);
    const Effort sorted = effort_of(keys);
    std::reverse(keys.begin(), keys.end());
    const Effort reversed = effort_of(keys);
    TestRandom random(n);
    for (auto& key : keys) key = static_cast<std::uint32_t>(random.bits());
    const Effort shuffled = effort_of(keys);
    std::printf("n = %zu: sorted %.2f reversed %.2f random %.2f comparisons / (n lg n)\n", n,
                per_n_lg_n(sorted.comparisons, n), per_n_lg_n(reversed.comparisons, n),
                per_n_lg_n(shuffled.comparisons, n));
    for (const Effort& effort : {sorted, reversed, shuffled}) {
      EXPECT_LE(per_n_lg_n(effort.comparisons, n), 10.0);
      EXPECT_LE(effort.depth, static_cast<int>(std::log2(static_cast<double>(n))))
          << "only the smaller part recurses";
    }
  }
}

TEST(SortGrowth, EqualKeysAreLinear) {
  for (const std::size_t n : {1000U, 100'000U, 1'000'000U}) {
    const Effort equal = effort_of(std::vector<std::uint32_t>(n, 7U));
    const double each = static_cast<double>(equal.comparisons) / static_cast<double>(n);
    std::printf("n = %zu: %.2f comparisons a key, all equal\n", n, each);
    EXPECT_LE(each, 10.0);
    EXPECT_LE(equal.depth, 2);
  }
}

TEST(SortGrowth, TwoDistinctKeysAreLinear) {
  std::vector<std::uint32_t> keys(1'000'000);
  for (std::size_t i = 0; i < keys.size(); ++i) keys[i] = static_cast<std::uint32_t>(i % 2);
  const Effort effort = effort_of(keys);
  EXPECT_LE(effort.comparisons, 20 * keys.size());
}

TEST(SortGrowth, SelectionIsLinear) {
  for (const std::size_t n : {1000U, 100'000U, 1'000'000U}) {
    std::vector<std::uint32_t> keys(n);
    TestRandom random(n);
    for (auto& key : keys) key = static_cast<std::uint32_t>(random.bits());
    auto sorted = keys;
    std::sort(sorted.begin(), sorted.end());
    for (const std::size_t k : {std::size_t{0}, n / 3, n - 1}) {
      auto work = keys;
      std::uint64_t comparisons = 0;
      const auto kth = select_kth(std::span(work), k, [&](std::uint32_t a, std::uint32_t b) {
        ++comparisons;
        return a < b;
      });
      EXPECT_EQ(kth, sorted[k]);
      EXPECT_LE(comparisons, 34 * n);
    }
  }
}

}  // namespace
}  // namespace raykiln::test
