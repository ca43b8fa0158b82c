// The kd-tree over triangles: an immutable value, its builder and its queries.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "raykiln/accel/task_runner.hpp"
#include "raykiln/math/ray.hpp"

namespace raykiln::render {

/// Triangles by vertex index. `opaque` is empty (all opaque) or holds one flag a triangle.
/// The spans must outlive the build only; the tree keeps its own copy of the vertices.
struct TriangleView {
  std::span<const Vec3f> positions;
  std::span<const std::array<std::uint32_t, 3>> triangles;
  std::span<const std::uint8_t> opaque;
};

/// Every number that shapes the tree. Part of the cache key together with kKdTreeVersion.
struct BuildParams {
  double k_t = 1.0;             ///< cost of one traversal step
  double k_i = 0.25;            ///< cost of one triangle test (amortised over a block)
  double empty_factor = 0.8;    ///< cost factor of a split that cuts off empty space
  double max_duplication = 4.0; ///< references are at most this multiple of the triangles
  int max_depth = 48;           ///< cap; the builder uses min(max_depth, 8 + 1.3 lg N)
  int leaf_width = 8;           ///< triangles a leaf block: 8 or 16
};
inline constexpr int kKdTreeVersion = 1;

/// What a build did; counts, so that complexity can be tested without a clock.
struct BuildStats {
  std::uint64_t triangles = 0, dropped_degenerate = 0;
  std::uint64_t nodes = 0, inner_nodes = 0, leaves = 0, empty_leaves = 0, references = 0;
  std::uint64_t events_swept = 0, events_moved = 0, keys_sorted_passes = 0, clips = 0;
  std::uint64_t bytes = 0;
  /// Most bytes held at once, in the order of one thread: the same for any runner. Each further
  /// thread may add a cell of 2 MiB. Not in it: the mesh that was given and the tree's copy of it.
  std::uint64_t live_bytes_peak = 0;
  int depth = 0;
  std::uint64_t splits_over_budget = 0;  ///< useful ones for which references or bytes did not suffice
  std::uint64_t splits_over_depth = 0;   ///< useful ones below the depth cap
  double sah_cost = 0.0;        ///< expected cost of a random ray that meets the box
  double leaf_cost = 0.0;       ///< the same if the whole tree were one leaf: testing everything
};

/// 8 bytes. Inner: split coordinate, (index of the left child << 2 | axis); the right child follows
/// the left. Leaf: block count, (index of the first block << 2 | 3).
struct KdNode {
  std::uint32_t split_or_count = 0;
  std::uint32_t index_and_axis = 3;
};
static_assert(sizeof(KdNode) == 8);

inline constexpr std::uint32_t kNoHit = 0xFFFFFFFFU;

/// Nearest meeting of a ray: t in units of |d|, triangle id, and barycentrics so that the point is
/// (1 - u - v) p0 + u p1 + v p2. A miss has id kNoHit and t = +inf.
struct Hit {
  float t = std::numeric_limits<float>::infinity();
  std::uint32_t id = kNoHit;
  float u = 0.0F;
  float v = 0.0F;
};
static_assert(sizeof(Hit) == 16);

/// Only hits strictly after (t, id) in lexicographic order count: how a caller passes on beyond a
/// surface that it decided to ignore, without an epsilon and without losing a coincident one.
struct HitOrder {
  float t = -std::numeric_limits<float>::infinity();
  std::uint32_t id = 0;
};

/// Counts that do not jitter; summed into by every query that gets a pointer.
struct TraversalCounters {
  std::uint64_t calls = 0, rays = 0, node_steps = 0, leaf_visits = 0, block_tests = 0;
  std::uint64_t unusable_rays = 0;  ///< not finite, no direction, empty interval: can hit nothing
  // What follows depends on the kernel, all above on tree and rays alone.
  std::uint64_t exact_tests = 0;  ///< triangles decided in double
  std::uint64_t lane_slots = 0;   ///< lanes times their steps; of these node_steps + leaf_visits had a ray

  TraversalCounters& operator+=(const TraversalCounters& other) {
    calls += other.calls;
    rays += other.rays;
    unusable_rays += other.unusable_rays;
    node_steps += other.node_steps;
    leaf_visits += other.leaf_visits;
    block_tests += other.block_tests;
    exact_tests += other.exact_tests;
    lane_slots += other.lane_slots;
    return *this;
  }
};

class KdTree;  // see kdtree_data.hpp for the arrays; most callers need only the functions below

/// Exact SAH kd-tree with split clipping in O(N log N) (Wald & Havran 2006). The tree is the same,
/// byte for byte, for any TaskRunner. Triangles of zero area are dropped and counted; positions
/// must be finite (checked by the scene). Returns nullptr if and only if runner.stop_requested().
[[nodiscard]] std::shared_ptr<const KdTree> build_kdtree(const TriangleView& mesh,
                                                         const BuildParams& params,
                                                         TaskRunner& runner);

[[nodiscard]] const BuildStats& build_stats(const KdTree& tree);
[[nodiscard]] Bounds3f bounds(const KdTree& tree);

/// How to find hits; what is found does not depend on it but for the triangle test. kTree takes the
/// fastest walk that the processor can run (kernels.hpp), kScalar one ray at a time: the reference for
/// the kernels below it, whose results and counters are the same bit for bit. A kernel that the
/// processor cannot run gives way to kScalar.
/// The first five test triangles watertightly. The others are the same with the fast test, in float
/// without a bound on its errors: they agree with each other bit for bit, and may miss a triangle that
/// is a few roundings wide.
enum class Traversal {
  kTree, kBruteForce, kScalar, kAvx2, kAvx512,
  kFastTree, kFastBruteForce, kFastScalar, kFastAvx2, kFastAvx512
};

/// Triangles on which rays begin (`from`) and end (`to`), one a ray or empty; kNoHit for none. A ray does not meet
/// them: it has left the plane of the one, and stops at that of the other. What rounding would make of it is not asked.
struct EndTriangles {
  std::span<const std::uint32_t> from{}, to{};

  /// Whether triangle `id` is one of them for ray i.
  [[nodiscard]] bool hold(std::size_t i, std::uint32_t id) const {
    return (!from.empty() && from[i] == id) || (!to.empty() && to[i] == id);
  }
};

/// For every ray the hit with the lowest (t, id); t, id, u, v do not depend on the tree, its
/// parameters or the traversal. Feed 1024 rays or more a call. `after` is empty or one a ray.
void closest_hits(const KdTree& tree, std::span<const Ray> rays, std::span<Hit> hits,
                  std::span<const HitOrder> after = {}, Traversal traversal = Traversal::kTree,
                  TraversalCounters* counters = nullptr, const EndTriangles& ends = {});

/// What stands in the way of a shadow ray.
enum class Occlusion : std::uint8_t {
  kNone = 0,       ///< nothing
  kOpaque = 1,     ///< an opaque triangle: blocked for certain
  kUndecided = 2,  ///< only non-opaque triangles: the caller decides, going through closest_hits
};

/// One answer a ray, as soon as an opaque triangle is found.
void any_hits(const KdTree& tree, std::span<const Ray> rays, std::span<Occlusion> result,
              Traversal traversal = Traversal::kTree, TraversalCounters* counters = nullptr,
              const EndTriangles& ends = {});

}  // namespace raykiln::render
