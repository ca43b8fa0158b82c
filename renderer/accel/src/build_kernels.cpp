// The builder's kernels for every processor.
#include "build_kernels.hpp"

namespace raykiln::render {
namespace {
constexpr int kLanes = 4;
}
}  // namespace raykiln::render

// Vectors wider than a register stay within this unit: how they would be passed is nobody's business.
#pragma GCC diagnostic ignored "-Wpsabi"

#include "kernel_bins.hpp"
#include "kernel_clip.hpp"
#include "kernel_planes.hpp"
#include "kernel_split.hpp"

namespace raykiln::render {

const BuildKernels kAnyBuildKernels{count_planes, count_planes_of_bin, count_bins, find_codes,
                                    bound_bins, split_references, clip_references, clip_triangle};

}  // namespace raykiln::render
