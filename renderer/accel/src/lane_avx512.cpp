// The lane kernels for processors with AVX-512 (F, DQ, BW, VL): compiled with flags of its own,
// includes nothing that another unit compiles too.
#include "lane_walk.hpp"
#include "lanes16.hpp"
#include "lanes8.hpp"

namespace raykiln::render {
namespace {

template <bool kAnyHit>
void walk8(const LaneQuery& query, LaneCounts& counts) {
  LaneWalk<Lanes16, Lanes8, 8, kAnyHit, 4> lanes(query, counts);
  lanes.run();
}

template <bool kAnyHit>
void walk16(const LaneQuery& query, LaneCounts& counts) {
  LaneWalk<Lanes16, Lanes16, 16, kAnyHit, 4> lanes(query, counts);
  lanes.run();
}

}  // namespace

LaneKernel avx512_kernel(LaneMode mode, int leaf_width) {
  if (mode == LaneMode::kAny) return leaf_width == 16 ? walk16<true> : walk8<true>;
  return leaf_width == 16 ? walk16<false> : walk8<false>;
}

}  // namespace raykiln::render
