// Where no processor of this architecture has kernels for several paths at once.
#include "axis_query.hpp"
#include "camera_query.hpp"
#include "matte_query.hpp"

namespace raykiln::render {

AxisKernel axis_kernel_avx2() { return nullptr; }
AxisKernel axis_kernel_avx512() { return nullptr; }
CameraKernel camera_kernel_avx2() { return nullptr; }
CameraKernel camera_kernel_avx512() { return nullptr; }
MatteKernel matte_kernel_avx2() { return nullptr; }
MatteKernel matte_kernel_avx512() { return nullptr; }

}  // namespace raykiln::render
