// The reference sort: quicksort whose pivot is the median of medians of five (Blum, Floyd, Pratt,
// Rivest & Tarjan 1973), so no input makes it quadratic, with a partition into less, equal and
// greater, so equal keys cost no more than one pass. Slower than what the product uses, and there
// to prove what that must equal; comparisons are counted by the caller's `less`.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>

namespace raykiln::test {

namespace median_sort_detail {

template <typename T, typename Less>
void insertion_sort(std::span<T> keys, Less& less) {
  for (std::size_t i = 1; i < keys.size(); ++i) {
    for (std::size_t j = i; j > 0 && less(keys[j], keys[j - 1]); --j) {
      std::swap(keys[j], keys[j - 1]);
    }
  }
}

/// Bounds of the keys equal to the pivot after the partition.
struct Equal {
  std::size_t begin, end;
};

// Dijkstra's three-way partition: one or two comparisons a key.
template <typename T, typename Less>
Equal partition(std::span<T> keys, const T& pivot, Less& less) {
  std::size_t low = 0;
  std::size_t i = 0;
  std::size_t high = keys.size();
  while (i < high) {
    if (less(keys[i], pivot)) {
      std::swap(keys[low++], keys[i++]);
    } else if (less(pivot, keys[i])) {
      std::swap(keys[i], keys[--high]);
    } else {
      ++i;
    }
  }
  return {low, high};
}

template <typename T, typename Less>
T select(std::span<T> keys, std::size_t k, Less& less);

// Medians of groups of five gather at the front; their median lies in the middle 3/10 .. 7/10.
template <typename T, typename Less>
T median_of_medians(std::span<T> keys, Less& less) {
  std::size_t medians = 0;
  for (std::size_t i = 0; i < keys.size(); i += 5) {
    const auto group = keys.subspan(i, std::min<std::size_t>(5, keys.size() - i));
    insertion_sort(group, less);
    std::swap(keys[medians++], group[group.size() / 2]);
  }
  return select(keys.first(medians), medians / 2, less);
}

template <typename T, typename Less>
T select(std::span<T> keys, std::size_t k, Less& less) {
  while (keys.size() > 5) {
    const T pivot = median_of_medians(keys, less);
    const Equal equal = partition(keys, pivot, less);
    if (k < equal.begin) {
      keys = keys.first(equal.begin);
    } else if (k < equal.end) {
      return pivot;
    } else {
      keys = keys.subspan(equal.end);
      k -= equal.end;
    }
  }
  insertion_sort(keys, less);
  return keys[k];
}

}  // namespace median_sort_detail

/// The k-th smallest key (k from 0) in linear time; changes the order of `keys`.
template <typename T, typename Less>
T select_kth(std::span<T> keys, std::size_t k, Less&& less) {
  return median_sort_detail::select(keys, k, less);
}

/// Sorts ascending in O(n log n) comparisons and O(log n) stack for every input. Not stable.
/// Returns the deepest recursion.
template <typename T, typename Less>
int median_of_medians_sort(std::span<T> keys, Less&& less) {
  int depth = 0;
  while (keys.size() > 5) {
    const T pivot = median_sort_detail::median_of_medians(keys, less);
    const auto equal = median_sort_detail::partition(keys, pivot, less);
    auto low = keys.first(equal.begin);
    auto high = keys.subspan(equal.end);
    if (low.size() > high.size()) std::swap(low, high);
    depth = std::max(depth, 1 + median_of_medians_sort(low, less));
    keys = high;
  }
  median_sort_detail::insertion_sort(keys, less);
  return depth;
}

}  // namespace raykiln::test
