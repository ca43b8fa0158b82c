// Which kernels for several paths at once go with a walk of the tree.
#pragma once

#include "raykiln/accel/kernels.hpp"

namespace raykiln::render {

/// What `avx512` or `avx2` returns; nullptr where the walk is the scalar one.
template <class Kernel>
Kernel kernel_with(Traversal traversal, Kernel (*avx512)(), Kernel (*avx2)()) {
  const Traversal chosen = with_test(resolve(traversal), TriangleTest::kWatertight);
  if (chosen == Traversal::kAvx512) return avx512();
  if (chosen == Traversal::kAvx2) return avx2();
  return nullptr;
}

}  // namespace raykiln::render
