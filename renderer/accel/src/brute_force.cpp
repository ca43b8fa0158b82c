#include "brute_force.hpp"

#include <algorithm>
#include <vector>

#include "triangle_test.hpp"

namespace raykiln::render {
namespace {

constexpr int kWidth = 8;

struct LiveRay {
  ShearedRay sheared;
  std::size_t index;  // in the caller's arrays
};

std::vector<LiveRay> prepare_all(std::span<const Ray> rays) {
  std::vector<LiveRay> live;
  live.reserve(rays.size());
  for (std::size_t i = 0; i < rays.size(); ++i) {
    LiveRay ray{{}, i};
    if (prepare(rays[i], ray.sheared)) live.push_back(ray);
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

template <typename Test>
void for_all_pairs(const KdTree& tree, std::span<const Ray> rays, TraversalCounters& counters,
                   Test&& test) {
  const std::vector<LiveRay> live = prepare_all(rays);
  counters.unusable_rays += rays.size() - live.size();
  LeafBlock<kWidth> block;
  for (std::size_t i = 0; i < tree.triangles.size();) {
    i = gather_block(tree, i, block);
    counters.block_tests += live.size();
    for (const LiveRay& ray : live) test(ray, block);
  }
}

}  // namespace

void closest_hits_brute_force(const KdTree& tree, std::span<const Ray> rays, std::span<Hit> hits,
                              std::span<const HitOrder> after, TraversalCounters& counters) {
  std::fill(hits.begin(), hits.end(), Hit{});
  for_all_pairs(tree, rays, counters, [&](const LiveRay& ray, const LeafBlock<kWidth>& block) {
    Hit& best = hits[ray.index];
    test_block(ray.sheared, block, counters.exact_tests, [&](const Hit& hit) {
      const bool counts = after.empty() || comes_after(hit, after[ray.index]);
      if (counts && comes_before(hit, best)) best = hit;
      return false;
    });
  });
}

void any_hits_brute_force(const KdTree& tree, std::span<const Ray> rays,
                          std::span<Occlusion> result, TraversalCounters& counters) {
  std::fill(result.begin(), result.end(), Occlusion::kNone);
  for_all_pairs(tree, rays, counters, [&](const LiveRay& ray, const LeafBlock<kWidth>& block) {
    Occlusion& found = result[ray.index];
    if (found == Occlusion::kOpaque) return;
    test_block(ray.sheared, block, counters.exact_tests, [&](const Hit& hit) {
      found = tree.opaque(hit.id) ? Occlusion::kOpaque : Occlusion::kUndecided;
      return found == Occlusion::kOpaque;
    });
  });
}

}  // namespace raykiln::render
