#include "brute_force.hpp"

#include <algorithm>
#include <vector>

#include "fast_test.hpp"
#include "triangle_test.hpp"

namespace raykiln::render {
namespace {

constexpr int kWidth = 8;

template <class Test>
struct LiveRay {
  typename Test::Prepared prepared;
  std::size_t index;  // in the caller's arrays
};

template <class Test>
std::vector<LiveRay<Test>> prepare_all(const KdTree& tree, std::span<const Ray> rays) {
  std::vector<LiveRay<Test>> live;
  live.reserve(rays.size());
  for (std::size_t i = 0; i < rays.size(); ++i) {
    LiveRay<Test> ray{{}, i};
    if (Test::prepare(rays[i], tree.box, ray.prepared)) live.push_back(ray);
  }
  return live;
}

// The triangles from `first` on that have an area, as one block; says where the next one begins.
std::size_t gather_block(const KdTree& tree, std::size_t first, LeafBlock<kWidth>& block) {
  block = {};
  block.id.fill(kNoHit);
  std::size_t lane = 0;
  std::size_t i = first;
  for (; i < tree.triangles.size() && lane < kWidth; ++i) {
    const auto& t = tree.triangles[i];
    const std::array<Vec3f, 3> p{tree.positions[t[0]], tree.positions[t[1]], tree.positions[t[2]]};
    if (has_zero_area(p[0], p[1], p[2])) continue;
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t k = 0; k < 3; ++k) block.v[c][k][lane] = p[c][static_cast<int>(k)];
    }
    block.id[lane++] = static_cast<std::uint32_t>(i);
  }
  return i;
}

template <class Test, typename Visit>
void for_all_pairs(const KdTree& tree, std::span<const Ray> rays, TraversalCounters& counters,
                   Visit&& visit) {
  const auto live = prepare_all<Test>(tree, rays);
  counters.unusable_rays += rays.size() - live.size();
  LeafBlock<kWidth> block;
  for (std::size_t i = 0; i < tree.triangles.size();) {
    i = gather_block(tree, i, block);
    counters.block_tests += live.size();
    for (const LiveRay<Test>& ray : live) visit(ray, block);
  }
}

template <class Test>
void closest(const KdTree& tree, std::span<const Ray> rays, std::span<Hit> hits,
             std::span<const HitOrder> after, const EndTriangles& ends, TraversalCounters& counters) {
  for_all_pairs<Test>(tree, rays, counters, [&](const auto& ray, const LeafBlock<kWidth>& block) {
    Hit& best = hits[ray.index];
    Test::block(ray.prepared, block, counters.exact_tests, [&](const Hit& hit) {
      if (ends.hold(ray.index, hit.id)) return false;
      const bool counts = after.empty() || comes_after(hit, after[ray.index]);
      if (counts && comes_before(hit, best)) best = hit;
      return false;
    });
  });
}

template <class Test>
void any(const KdTree& tree, std::span<const Ray> rays, std::span<Occlusion> result,
         const EndTriangles& ends, TraversalCounters& counters) {
  for_all_pairs<Test>(tree, rays, counters, [&](const auto& ray, const LeafBlock<kWidth>& block) {
    Occlusion& found = result[ray.index];
    if (found == Occlusion::kOpaque) return;
    Test::block(ray.prepared, block, counters.exact_tests, [&](const Hit& hit) {
      if (ends.hold(ray.index, hit.id)) return false;
      found = tree.opaque(hit.id) ? Occlusion::kOpaque : Occlusion::kUndecided;
      return found == Occlusion::kOpaque;
    });
  });
}

}  // namespace

void closest_hits_brute_force(const KdTree& tree, std::span<const Ray> rays, std::span<Hit> hits,
                              std::span<const HitOrder> after, const EndTriangles& ends, TriangleTest test,
                              TraversalCounters& counters) {
  std::fill(hits.begin(), hits.end(), Hit{});
  const auto search = test == TriangleTest::kFast ? closest<FastTest> : closest<WatertightTest>;
  search(tree, rays, hits, after, ends, counters);
}

void any_hits_brute_force(const KdTree& tree, std::span<const Ray> rays,
                          std::span<Occlusion> result, const EndTriangles& ends, TriangleTest test,
                          TraversalCounters& counters) {
  std::fill(result.begin(), result.end(), Occlusion::kNone);
  const auto search = test == TriangleTest::kFast ? any<FastTest> : any<WatertightTest>;
  search(tree, rays, result, ends, counters);
}

}  // namespace raykiln::render
