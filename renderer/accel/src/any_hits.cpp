#include <cassert>

#include "brute_force.hpp"
#include "lane_search.hpp"
#include "raykiln/accel/kernels.hpp"
#include "scalar_walk.hpp"

namespace raykiln::render {
namespace {

template <int W>
Occlusion any_hit(const KdTree& tree, const std::vector<LeafBlock<W>>& blocks, const Ray& ray,
                  TraversalCounters& counters) {
  Occlusion found = Occlusion::kNone;
  ShearedRay sheared;
  if (!prepare(ray, sheared)) {
    ++counters.unusable_rays;
    return found;
  }
  if (tree.box.empty()) return found;
  constexpr float kNoLimit = std::numeric_limits<float>::infinity();
  ScalarWalk walk(tree, ray, counters);
  walk.run(kNoLimit, [&](std::uint32_t first, std::uint32_t count) {
    for (std::uint32_t b = first; b < first + count; ++b) {
      ++counters.block_tests;
      const bool opaque = test_block(sheared, blocks[b], counters.exact_tests, [&](const Hit& hit) {
        found = tree.opaque(hit.id) ? Occlusion::kOpaque : Occlusion::kUndecided;
        return found == Occlusion::kOpaque;
      });
      if (opaque) return true;
    }
    return false;
  });
  return found;
}

}  // namespace

void any_hits(const KdTree& tree, std::span<const Ray> rays, std::span<Occlusion> result,
              Traversal traversal, TraversalCounters* counters) {
  assert(result.size() >= rays.size());
  TraversalCounters counts;
  counts.calls = 1;
  counts.rays = rays.size();
  const Traversal chosen = resolve(traversal);
  const LaneKernel kernel = rays.size() < kFewRays || tree.box.empty()
                                ? nullptr
                                : lane_kernel(chosen, LaneMode::kAny, tree.params.leaf_width);
  if (chosen == Traversal::kBruteForce) {
    any_hits_brute_force(tree, rays, result.first(rays.size()), counts);
  } else if (kernel != nullptr) {
    any_hits_in_lanes(kernel, tree, rays, result.first(rays.size()), counts);
  } else {
    with_blocks(tree, [&](const auto& blocks) {
      for (std::size_t i = 0; i < rays.size(); ++i) {
        result[i] = any_hit(tree, blocks, rays[i], counts);
      }
    });
  }
  if (counters != nullptr) *counters += counts;
}

}  // namespace raykiln::render
