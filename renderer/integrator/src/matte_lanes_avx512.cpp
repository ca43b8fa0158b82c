// The kernel for processors with AVX-512: compiled with flags of its own, includes nothing that another unit
// compiles too.
#include <immintrin.h>

namespace raykiln::render {
namespace {
constexpr int kLanes = 8;
}
}  // namespace raykiln::render

#include "matte_lanes.hpp"

namespace raykiln::render {

MatteKernel matte_kernel_avx512() { return shade_matte_lanes; }

}  // namespace raykiln::render
