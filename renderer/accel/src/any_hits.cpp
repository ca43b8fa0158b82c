#include <cassert>

#include "brute_force.hpp"
#include "fast_test.hpp"
#include "lane_search.hpp"
#include "raykiln/accel/kernels.hpp"
#include "scalar_walk.hpp"

namespace raykiln::render {
namespace {

template <class Test, int W>
Occlusion any_hit(const KdTree& tree, const std::vector<LeafBlock<W>>& blocks, const Ray& ray,
                  const EndTriangles& ends, std::size_t i, TraversalCounters& counters) {
  Occlusion found = Occlusion::kNone;
  typename Test::Prepared prepared;
  if (!Test::prepare(ray, tree.box, prepared)) {
    ++counters.unusable_rays;
    return found;
  }
  if (tree.box.empty()) return found;
  constexpr float kNoLimit = std::numeric_limits<float>::infinity();
  ScalarWalk walk(Test{}, tree, ray, counters);
  walk.run(kNoLimit, [&](std::uint32_t first, std::uint32_t count) {
    for (std::uint32_t b = first; b < first + count; ++b) {
      ++counters.block_tests;
      const bool opaque = Test::block(prepared, blocks[b], counters.exact_tests, [&](const Hit& hit) {
        if (ends.hold(i, hit.id)) return false;
        found = tree.opaque(hit.id) ? Occlusion::kOpaque : Occlusion::kUndecided;
        return found == Occlusion::kOpaque;
      });
      if (opaque) return true;
    }
    return false;
  });
  return found;
}

template <class Test>
void one_by_one(const KdTree& tree, std::span<const Ray> rays, std::span<Occlusion> result,
                const EndTriangles& ends, TraversalCounters& counters) {
  with_blocks(tree, [&](const auto& blocks) {
    for (std::size_t i = 0; i < rays.size(); ++i) {
      result[i] = any_hit<Test>(tree, blocks, rays[i], ends, i, counters);
    }
  });
}

}  // namespace

void any_hits(const KdTree& tree, std::span<const Ray> rays, std::span<Occlusion> result,
              Traversal traversal, TraversalCounters* counters, const EndTriangles& ends) {
  assert(result.size() >= rays.size());
  TraversalCounters counts;
  counts.calls = 1;
  counts.rays = rays.size();
  const Traversal chosen = resolve(traversal);
  const TriangleTest test = test_of(chosen);
  const LaneKernel kernel = rays.size() < kFewRays || tree.box.empty()
                                ? nullptr
                                : lane_kernel(chosen, LaneMode::kAny, tree.params.leaf_width);
  if (chosen == Traversal::kBruteForce || chosen == Traversal::kFastBruteForce) {
    any_hits_brute_force(tree, rays, result.first(rays.size()), ends, test, counts);
  } else if (kernel != nullptr) {
    any_hits_in_lanes(kernel, tree, rays, result.first(rays.size()), ends, test, counts);
  } else if (test == TriangleTest::kFast) {
    one_by_one<FastTest>(tree, rays, result, ends, counts);
  } else {
    one_by_one<WatertightTest>(tree, rays, result, ends, counts);
  }
  if (counters != nullptr) *counters += counts;
}

}  // namespace raykiln::render
