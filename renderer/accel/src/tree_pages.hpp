// Memory of a tree in large pages: a walk goes all over it, and with small pages every other block
// waits for the page table, too.
#pragma once

#include <vector>

#include "raykiln/accel/kdtree_data.hpp"

namespace raykiln::render {

/// Asks the system to move `bytes` at `begin` to pages of 2 MiB where whole ones fit. It may decline,
/// and costs no memory.
void prefer_large_pages(const void* begin, std::size_t bytes);

/// The same before the memory is first written, which saves the move.
void expect_large_pages(const void* begin, std::size_t bytes);

/// Makes an empty vector as long, in large pages where it can be.
template <typename T>
void resize_in_large_pages(std::vector<T>& v, std::size_t n) {
  v.reserve(n);
  expect_large_pages(v.data(), n * sizeof(T));
  v.resize(n);
}

inline void prefer_large_pages(const KdTree& tree) {
  const auto all_of = [](const auto& v) { prefer_large_pages(v.data(), v.size() * sizeof(v[0])); };
  all_of(tree.nodes);
  all_of(tree.blocks8);
  all_of(tree.blocks16);
}

}  // namespace raykiln::render
