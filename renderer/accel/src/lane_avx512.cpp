// The lane kernels for processors with AVX-512 (F, DQ, BW, VL): compiled with flags of its own,
// includes nothing that another unit compiles too.
#include "lane_leaf.hpp"
#include "lane_walk.hpp"
#include "lanes16.hpp"
#include "lanes8.hpp"

namespace raykiln::render {
namespace {

constexpr std::size_t kGroups = 4;

template <bool kAnyHit>
void walk8(const LaneQuery& query, LaneCounts& counts) {
  using Leaf = LeafVisit<Lanes16, Lanes8, Lanes8Twice, Doubles8, Doubles4, 8, kAnyHit>;
  LaneWalk<Lanes16, Leaf, kAnyHit, kGroups> lanes(query, counts);
  lanes.run();
}

template <bool kAnyHit>
void walk16(const LaneQuery& query, LaneCounts& counts) {
  using Leaf = LeafVisit<Lanes16, Lanes16, Lanes16, Doubles8, Doubles4, 16, kAnyHit>;
  LaneWalk<Lanes16, Leaf, kAnyHit, kGroups> lanes(query, counts);
  lanes.run();
}

}  // namespace

LaneKernel avx512_kernel(LaneMode mode, int leaf_width) {
  if (mode == LaneMode::kAny) return leaf_width == 16 ? walk16<true> : walk8<true>;
  return leaf_width == 16 ? walk16<false> : walk8<false>;
}

}  // namespace raykiln::render
