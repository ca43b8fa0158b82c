#include "gap_walk.hpp"

namespace raykiln::render {

void GapWalk::launch(const KdTree& tree, Traversal traversal, std::span<const Ray> rays,
                     std::span<const Hit> hits, RenderStats& stats) {
  rays_.clear();
  after_.clear();
  for (const std::size_t i : waiting_) {
    rays_.push_back(rays[i]);
    rays_.back().t_min = hits[i].t;  // cells that lie before it need no visit
    after_.push_back({hits[i].t, hits[i].id});
  }
  found_.resize(rays_.size());
  closest_hits(tree, rays_, found_, after_, traversal, &stats.traversal);
  stats.gap_rays += rays_.size();
}

// One number decides for all surfaces that a ray meets: it passes the first k of them where the number is
// below the product of what they let through, (1 - c_1) .. (1 - c_k). Where c is 0 or 1, as a mask has it,
// the number does not matter.
void GapWalk::paths(const Transport& transport, std::span<const Ray> rays,
                    std::span<PathState> states, std::span<Hit> hits,
                    std::span<PathResult> results, RenderStats& stats) {
  passed_.assign(rays.size(), 1.0);
  const auto stops = [&](std::size_t i, const Hit& hit) {
    const double coverage = transport.gaps.met(place_of(hit), Vec3d(rays[i].d));
    if (coverage >= 1.0) return true;
    if (!(coverage > 0.0)) return false;
    const PathState& state = states[i];
    passed_[i] *= 1.0 - coverage;
    const VertexKey key = vertex_key(state.key, state.node, state.bounce);
    return uniform(key, Dimension::kCoverage) >= passed_[i];
  };
  const auto give_up = [&](std::size_t i) {
    states[i].throughput = Rgbd(0.0);
    results[states[i].slot].truncated = true;
  };
  go_on(transport.tree, transport.settings.traversal, rays, hits, stats, stops, give_up);
}

}  // namespace raykiln::render
