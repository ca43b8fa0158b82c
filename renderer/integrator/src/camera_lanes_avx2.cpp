// The kernel for processors with AVX2: compiled with flags of its own, includes nothing that another unit
// compiles too.
#include <immintrin.h>

namespace raykiln::render {
namespace {
constexpr int kLanes = 4;
}
}  // namespace raykiln::render

#include "camera_lanes.hpp"

namespace raykiln::render {

CameraKernel camera_kernel_avx2() { return shoot_camera_lanes; }

}  // namespace raykiln::render
