#include "lane_search.hpp"

#include <algorithm>
#include <bit>

#include "fast_test.hpp"
#include "triangle_test.hpp"

namespace raykiln::render {
namespace {

static_assert(kLaneStack >= kMaxKdDepth + 2 && kLaneNoHit == kNoHit);

/// The ray with what its lane keeps for it; see shear_ray.
ShearedRay made_ready(const WatertightTest& /*test*/, const Ray& ray, const Bounds3f& /*box*/,
                      const LaneShear& shear) {
  ShearedRay sheared;
  const std::size_t kz = shear.main_axis;
  sheared.o = {ray.o.x, ray.o.y, ray.o.z};
  sheared.k = {kz == 2 ? 0 : kz + 1, kz == 0 ? 2 : kz - 1, kz};
  sheared.sx = shear.sx;
  sheared.sy = shear.sy;
  sheared.inv_dz = shear.inv_dz;
  sheared.t_min = ray.t_min;
  sheared.t_max = ray.t_max;
  return sheared;
}

FastRay made_ready(const FastTest& /*test*/, const Ray& ray, const Bounds3f& box,
                   const LaneShear& /*shear*/) {
  FastRay ready;
  (void)FastTest::prepare(ray, box, ready);  // a ray in a lane is usable
  return ready;
}

/// Calls accept(hit) for the hits among `lanes` of the block until it returns true.
template <class Test, int W, typename Accept>
void decide_lanes(const typename Test::Prepared& ray, const LeafBlock<W>& block, std::uint32_t lanes,
                  Accept&& accept) {
  for (; lanes != 0; lanes &= lanes - 1) {
    Hit hit;
    if (!Test::lane(ray, block, static_cast<std::size_t>(std::countr_zero(lanes)), hit)) continue;
    if (accept(hit)) return;
  }
}

template <class SomeTest, int W>
struct Closest {
  using Test = SomeTest;
  const LeafBlock<W>* blocks;
  std::span<const Ray> rays;
  std::span<Hit> hits;
  std::span<const HitOrder> after;
  const EndTriangles& ends;
  const KdTree& tree;
  bool has_ends = !ends.from.empty() || !ends.to.empty();

  LaneBest decide(std::size_t ray, const typename Test::Prepared& ready,
                  std::uint32_t block, std::uint32_t lanes) {
    decide_lanes<Test>(ready, blocks[block], lanes, [&](const Hit& hit) {
      keep(ray, hit);
      return false;
    });
    return {hits[ray].t, hits[ray].id};
  }

  LaneBest keep(std::size_t ray, const Hit& hit) {
    Hit& best = hits[ray];
    const bool counts = !(has_ends && ends.hold(ray, hit.id)) && (after.empty() || comes_after(hit, after[ray]));
    if (counts && comes_before(hit, best)) best = hit;
    return {best.t, best.id};
  }
};

template <class SomeTest, int W>
struct Any {
  using Test = SomeTest;
  const LeafBlock<W>* blocks;
  std::span<const Ray> rays;
  std::span<Occlusion> result;
  const EndTriangles& ends;
  const KdTree& tree;
  bool has_ends = !ends.from.empty() || !ends.to.empty();

  LaneBest decide(std::size_t ray, const typename Test::Prepared& ready,
                  std::uint32_t block, std::uint32_t lanes) {
    LaneBest found{0.0F, kNoHit};
    decide_lanes<Test>(ready, blocks[block], lanes, [&](const Hit& hit) {
      found = keep(ray, hit);
      return found.id != kNoHit;
    });
    return found;
  }

  LaneBest keep(std::size_t ray, const Hit& hit) {
    if (has_ends && ends.hold(ray, hit.id)) return {0.0F, kNoHit};
    const bool opaque = tree.opaque(hit.id);
    result[ray] = opaque ? Occlusion::kOpaque : Occlusion::kUndecided;
    return opaque ? LaneBest{hit.t, hit.id} : LaneBest{0.0F, kNoHit};
  }
};

template <typename Search>
void run(LaneKernel kernel, const KdTree& tree, Search& search, TraversalCounters& counters) {
  static_assert(sizeof(Ray) == 8 * sizeof(float));
  LaneQuery query{};
  query.nodes = tree.nodes.data();
  query.node_count = tree.nodes.size();
  query.blocks = reinterpret_cast<const float*>(search.blocks);
  query.rays = reinterpret_cast<const float*>(search.rays.data());
  query.ray_count = search.rays.size();
  for (int k = 0; k < 3; ++k) {
    query.box_lo[k] = tree.box.lo[k];
    query.box_hi[k] = tree.box.hi[k];
  }
  query.context = &search;
  query.from = search.ends.from.empty() ? nullptr : search.ends.from.data();
  query.to = search.ends.to.empty() ? nullptr : search.ends.to.data();
  query.decide = [](void* context, std::size_t ray, const LaneShear& shear, std::uint32_t block,
                    std::uint32_t lanes) {
    auto& asked = *static_cast<Search*>(context);
    const auto ready =
        made_ready(typename Search::Test{}, asked.rays[ray], asked.tree.box, shear);
    return asked.decide(ray, ready, block, lanes);
  };
  query.keep = [](void* context, std::size_t ray, float t, std::uint32_t id, float u, float v) {
    return static_cast<Search*>(context)->keep(ray, {t, id, u, v});
  };
  LaneCounts counts{};
  kernel(query, counts);
  counters.node_steps += counts.node_steps;
  counters.leaf_visits += counts.leaf_visits;
  counters.block_tests += counts.block_tests;
  counters.unusable_rays += counts.unusable_rays;
  counters.lane_slots += counts.lane_slots;
  counters.exact_tests += counts.exact_tests;
}

template <class Test>
void closest(LaneKernel kernel, const KdTree& tree, std::span<const Ray> rays, std::span<Hit> hits,
             std::span<const HitOrder> after, const EndTriangles& ends, TraversalCounters& counters) {
  with_blocks(tree, [&]<int W>(const std::vector<LeafBlock<W>>& blocks) {
    Closest<Test, W> search{blocks.data(), rays, hits, after, ends, tree};
    run(kernel, tree, search, counters);
  });
}

template <class Test>
void any(LaneKernel kernel, const KdTree& tree, std::span<const Ray> rays,
         std::span<Occlusion> result, const EndTriangles& ends, TraversalCounters& counters) {
  with_blocks(tree, [&]<int W>(const std::vector<LeafBlock<W>>& blocks) {
    Any<Test, W> search{blocks.data(), rays, result, ends, tree};
    run(kernel, tree, search, counters);
  });
}

}  // namespace

LaneKernel lane_kernel(Traversal traversal, LaneMode mode, int leaf_width) {
#ifdef RAYKILN_X86_KERNELS
  switch (traversal) {
    case Traversal::kAvx2: return avx2_kernel(mode, leaf_width);
    case Traversal::kAvx512: return avx512_kernel(mode, leaf_width);
    case Traversal::kFastAvx2: return fast_avx2_kernel(mode, leaf_width);
    case Traversal::kFastAvx512: return fast_avx512_kernel(mode, leaf_width);
    default: break;
  }
#else
  (void)traversal, (void)mode, (void)leaf_width;
#endif
  return nullptr;
}

void closest_hits_in_lanes(LaneKernel kernel, const KdTree& tree, std::span<const Ray> rays,
                           std::span<Hit> hits, std::span<const HitOrder> after, const EndTriangles& ends, TriangleTest test,
                           TraversalCounters& counters) {
  std::fill(hits.begin(), hits.end(), Hit{});
  const auto search = test == TriangleTest::kFast ? closest<FastTest> : closest<WatertightTest>;
  search(kernel, tree, rays, hits, after, ends, counters);
}

void any_hits_in_lanes(LaneKernel kernel, const KdTree& tree, std::span<const Ray> rays,
                       std::span<Occlusion> result, const EndTriangles& ends, TriangleTest test,
                       TraversalCounters& counters) {
  std::fill(result.begin(), result.end(), Occlusion::kNone);
  const auto search = test == TriangleTest::kFast ? any<FastTest> : any<WatertightTest>;
  search(kernel, tree, rays, result, ends, counters);
}

}  // namespace raykiln::render
