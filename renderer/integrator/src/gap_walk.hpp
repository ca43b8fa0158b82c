// Rays that met a surface where it is not, and go on.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "path_stream.hpp"
#include "raykiln/accel/kdtree.hpp"
#include "raykiln/integrator/path_tracer.hpp"
#include "raykiln/integrator/render_stats.hpp"
#include "raykiln/shading/texture_lookup.hpp"
#include "transport.hpp"

namespace raykiln::render {

[[nodiscard]] inline TrianglePlace place_of(const Hit& hit) {
  return {hit.id, static_cast<double>(hit.u), static_cast<double>(hit.v)};
}

/// A ray goes on as itself, from the t of the hit that it passed, and finds what comes strictly after that
/// (t, id): no length is added to it, and what lies in the same place is not missed.
class GapWalk {
 public:
  /// Surfaces that one ray may pass.
  static constexpr int kMostGaps = 1024;

  /// `stops(i, hit)` says whether ray i ends at this hit; it is asked once for each, in the order in which
  /// the ray meets them. Where the answer is no, hits[i] becomes the next one, or a miss. A ray that has
  /// passed kMostGaps surfaces is given up: `give_up(i)` is called, and hits[i] is a miss.
  template <class Stops, class GiveUp>
  void go_on(const KdTree& tree, Traversal traversal, std::span<const Ray> rays, std::span<Hit> hits,
             RenderStats& stats, Stops&& stops, GiveUp&& give_up) {
    waiting_.clear();
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (hits[i].id != kNoHit && !stops(i, hits[i])) waiting_.push_back(i);
    }
    for (int gaps = 1; !waiting_.empty() && gaps <= kMostGaps; ++gaps) {
      launch(tree, traversal, rays, hits, stats);
      std::size_t left = 0;
      for (std::size_t k = 0; k < waiting_.size(); ++k) {
        const std::size_t i = waiting_[k];
        hits[i] = found_[k];
        if (hits[i].id != kNoHit && !stops(i, hits[i])) waiting_[left++] = i;
      }
      waiting_.resize(left);
    }
    for (const std::size_t i : waiting_) {
      hits[i] = Hit{};
      give_up(i);
    }
  }

  /// The same for paths: a surface of coverage c ends a ray with probability c. One that is given up is
  /// truncated and brings nothing from there on.
  void paths(const Transport& transport, std::span<const Ray> rays, std::span<PathState> states,
             std::span<Hit> hits, std::span<PathResult> results, RenderStats& stats);

 private:
  void launch(const KdTree& tree, Traversal traversal, std::span<const Ray> rays,
              std::span<const Hit> hits, RenderStats& stats);

  std::vector<std::size_t> waiting_;  ///< rays that go on
  std::vector<Ray> rays_;
  std::vector<HitOrder> after_;
  std::vector<Hit> found_;
  std::vector<double> passed_;  ///< probability of a path's having come so far
};

}  // namespace raykiln::render
