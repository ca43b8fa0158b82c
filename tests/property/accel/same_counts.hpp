// What the counters of all kernels must share over the same rays.
#pragma once

#include <gtest/gtest.h>

#include "raykiln/accel/kdtree.hpp"

namespace raykiln::test {

inline void expect_same_counts(const render::TraversalCounters& a, const render::TraversalCounters& b) {
  EXPECT_EQ(a.rays, b.rays);
  EXPECT_EQ(a.unusable_rays, b.unusable_rays);
  EXPECT_EQ(a.node_steps, b.node_steps);
  EXPECT_EQ(a.leaf_visits, b.leaf_visits);
  EXPECT_EQ(a.block_tests, b.block_tests);
}

}  // namespace raykiln::test
