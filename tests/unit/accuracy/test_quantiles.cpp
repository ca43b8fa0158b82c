#include <gtest/gtest.h>

#include <cmath>

#include "raykiln/accuracy/quantiles.hpp"

namespace raykiln::render {
namespace {

TEST(Quantiles, StudentMatchesTheTables) {
  EXPECT_TRUE(std::isinf(student_t95(0.0)));
  EXPECT_TRUE(std::isinf(student_t95(std::nan(""))));
  EXPECT_NEAR(student_t95(1.0), 12.7062, 1e-4);
  EXPECT_NEAR(student_t95(2.0), 4.30265, 1e-5);
  EXPECT_NEAR(student_t95(3.0), 3.18245, 2e-2);
  EXPECT_NEAR(student_t95(7.0), 2.36462, 5e-4);
  EXPECT_NEAR(student_t95(30.0), 2.04227, 1e-5);
  EXPECT_NEAR(student_t95(1e9), kNormal95, 1e-8);
}

}  // namespace
}  // namespace raykiln::render
