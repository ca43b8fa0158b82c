// The kernel for processors with AVX-512: compiled with flags of its own, includes nothing that another unit
// compiles too.
#include <immintrin.h>

namespace raykiln::render {
namespace {
constexpr int kLanes = 8;
}
}  // namespace raykiln::render

#include "axis_lanes.hpp"

namespace raykiln::render {

AxisKernel axis_kernel_avx512() { return shade_axis_lanes; }

}  // namespace raykiln::render
