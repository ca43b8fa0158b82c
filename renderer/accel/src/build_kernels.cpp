// The builder's kernels for every processor.
#include "build_kernels.hpp"

namespace raykiln::render {
namespace {
constexpr int kLanes = 4;
}
}  // namespace raykiln::render

#include "kernel_bins.hpp"
#include "kernel_planes.hpp"
#include "kernel_split.hpp"

namespace raykiln::render {

const BuildKernels kAnyBuildKernels{count_planes, count_bins, find_codes, bound_bins,
                                    split_references};

}  // namespace raykiln::render
