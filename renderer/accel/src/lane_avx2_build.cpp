// The builder's kernels for processors with AVX2: compiled with flags of its own, includes nothing that
// another unit compiles too.
#include "build_kernels.hpp"

namespace raykiln::render {
namespace {
constexpr int kLanes = 8;
}
}  // namespace raykiln::render

#include "kernel_bins.hpp"
#include "kernel_clip.hpp"
#include "kernel_planes.hpp"
#include "kernel_split.hpp"

namespace raykiln::render {

const BuildKernels kAvx2BuildKernels{count_planes, count_planes_of_bin, count_bins, find_codes,
                                    bound_bins, split_references, clip_references, clip_triangle};

}  // namespace raykiln::render
