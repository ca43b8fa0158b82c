#include <cassert>

#include "brute_force.hpp"
#include "fast_test.hpp"
#include "lane_search.hpp"
#include "raykiln/accel/kernels.hpp"
#include "scalar_walk.hpp"

namespace raykiln::render {
namespace {

template <class Test, int W>
Hit closest_hit(const KdTree& tree, const std::vector<LeafBlock<W>>& blocks, const Ray& ray,
                const HitOrder* after, const EndTriangles& ends, std::size_t i,
                TraversalCounters& counters) {
  Hit best;
  typename Test::Prepared prepared;
  if (!Test::prepare(ray, tree.box, prepared)) {
    ++counters.unusable_rays;
    return best;
  }
  if (tree.box.empty()) return best;
  ScalarWalk walk(Test{}, tree, ray, counters);
  walk.run(best.t, [&](std::uint32_t first, std::uint32_t count) {
    counters.block_tests += count;
    for (std::uint32_t b = first; b < first + count; ++b) {
      Test::block(prepared, blocks[b], counters.exact_tests, [&](const Hit& hit) {
        const bool counts = !ends.hold(i, hit.id) && (after == nullptr || comes_after(hit, *after));
        if (counts && comes_before(hit, best)) best = hit;
        return false;
      });
    }
    return false;
  });
  return best;
}

template <class Test>
void one_by_one(const KdTree& tree, std::span<const Ray> rays, std::span<Hit> hits,
                std::span<const HitOrder> after, const EndTriangles& ends, TraversalCounters& counters) {
  with_blocks(tree, [&](const auto& blocks) {
    for (std::size_t i = 0; i < rays.size(); ++i) {
      hits[i] = closest_hit<Test>(tree, blocks, rays[i], after.empty() ? nullptr : &after[i],
                                  ends, i, counters);
    }
  });
}

}  // namespace

void closest_hits(const KdTree& tree, std::span<const Ray> rays, std::span<Hit> hits,
                  std::span<const HitOrder> after, Traversal traversal,
                  TraversalCounters* counters, const EndTriangles& ends) {
  assert(hits.size() >= rays.size() && (after.empty() || after.size() >= rays.size()));
  TraversalCounters counts;
  counts.calls = 1;
  counts.rays = rays.size();
  const Traversal chosen = resolve(traversal);
  const TriangleTest test = test_of(chosen);
  const LaneKernel kernel = rays.size() < kFewRays || tree.box.empty()
                                ? nullptr
                                : lane_kernel(chosen, LaneMode::kClosest, tree.params.leaf_width);
  if (chosen == Traversal::kBruteForce || chosen == Traversal::kFastBruteForce) {
    closest_hits_brute_force(tree, rays, hits.first(rays.size()), after, ends, test, counts);
  } else if (kernel != nullptr) {
    closest_hits_in_lanes(kernel, tree, rays, hits.first(rays.size()), after, ends, test, counts);
  } else if (test == TriangleTest::kFast) {
    one_by_one<FastTest>(tree, rays, hits, after, ends, counts);
  } else {
    one_by_one<WatertightTest>(tree, rays, hits, after, ends, counts);
  }
  if (counters != nullptr) *counters += counts;
}

}  // namespace raykiln::render
