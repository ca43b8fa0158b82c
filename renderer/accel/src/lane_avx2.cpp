// The lane kernels for processors with AVX2: compiled with flags of its own, includes nothing that
// another unit compiles too.
#include "lane_leaf.hpp"
#include "lane_walk.hpp"
#include "lanes8.hpp"

namespace raykiln::render {
namespace {

template <int kLeafWidth, bool kAnyHit>
void walk(const LaneQuery& query, LaneCounts& counts) {
  using Leaf = LeafVisit<Lanes8, Lanes8, Lanes8, Doubles4, Doubles4, kLeafWidth, kAnyHit>;
  LaneWalk<Lanes8, Leaf, kAnyHit, 4> lanes(query, counts);
  lanes.run();
}

}  // namespace

LaneKernel avx2_kernel(LaneMode mode, int leaf_width) {
  if (mode == LaneMode::kAny) return leaf_width == 16 ? walk<16, true> : walk<8, true>;
  return leaf_width == 16 ? walk<16, false> : walk<8, false>;
}

}  // namespace raykiln::render
