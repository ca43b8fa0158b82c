// What passes between the code for every processor and the lane kernels, each of which is compiled
// for one instruction set. Plain data and pointers only: an inline function here would be compiled
// once with AVX and once without, and the linker would keep either.
#pragma once

#include <cstddef>
#include <cstdint>

namespace raykiln::render {

/// The id of no triangle.
constexpr std::uint32_t kLaneNoHit = 0xFFFFFFFFU;
/// Entries of a walk's stack, one of them for a store that is not kept.
constexpr std::uint32_t kLaneStack = 66;

/// Best hit so far of a ray: cells behind t need no visit, triangle `id` need not be decided again.
struct LaneBest {
  float t;
  std::uint32_t id;
};

/// A ray made ready for the test in double, see shear_ray; nothing of use with the fast test.
struct LaneShear {
  double sx, sy, inv_dz;
  std::uint64_t main_axis;
};

struct LaneCounts {
  std::uint64_t node_steps, leaf_visits, block_tests, unusable_rays, lane_slots, exact_tests;
};

/// Rays to be walked through one tree. The kernel finds leaf blocks and the lanes in them that may
/// be hit, decides them in double, and lets `keep` choose among the hits.
struct LaneQuery {
  const void* nodes;   ///< KdNode
  std::uint64_t node_count;
  const float* blocks; ///< LeafBlock<leaf_width>
  const float* rays;   ///< Ray: 8 floats each
  std::size_t ray_count;
  float box_lo[3], box_hi[3];
  /// Triangles that rays begin and end on, which need not be decided, as `keep` takes none of them; or nullptr.
  const std::uint32_t* from;
  const std::uint32_t* to;

  /// Called for a hit within the ray's interval. Closest-hit: the best hit from now on. Any-hit: an
  /// id other than kLaneNoHit ends the ray.
  LaneBest (*keep)(void* context, std::size_t ray, float t, std::uint32_t id, float u, float v);
  /// The same for `lanes` (a bit each) of `block` of which it is not known whether they are hit.
  LaneBest (*decide)(void* context, std::size_t ray, const LaneShear& shear, std::uint32_t block,
                     std::uint32_t lanes);
  void* context;
};

/// A kernel for one leaf width and kind of query.
using LaneKernel = void (*)(const LaneQuery& query, LaneCounts& counts);

enum class LaneMode : std::uint8_t { kClosest, kAny };

/// nullptr where this build has no such kernel. Whether the processor can run it is another matter.
LaneKernel avx2_kernel(LaneMode mode, int leaf_width);
LaneKernel avx512_kernel(LaneMode mode, int leaf_width);
/// With the fast triangle test.
LaneKernel fast_avx2_kernel(LaneMode mode, int leaf_width);
LaneKernel fast_avx512_kernel(LaneMode mode, int leaf_width);

}  // namespace raykiln::render
