// The kernel for processors with AVX2: compiled with flags of its own, includes nothing that another unit
// compiles too.
#include <immintrin.h>

namespace raykiln::render {
namespace {
constexpr int kLanes = 4;
}
}  // namespace raykiln::render

#include "axis_lanes.hpp"

namespace raykiln::render {

AxisKernel axis_kernel_avx2() { return shade_axis_lanes; }

}  // namespace raykiln::render
