#include "raykiln/integrator/path_tracer.hpp"

#include <algorithm>
#include <cmath>

#include "path_stream.hpp"
#include "shadow_queue.hpp"
#include "vertex_shading.hpp"

namespace raykiln::render {
namespace {

constexpr std::size_t kStreamPaths = 4096;  ///< paths kept under way while there are so many
constexpr std::size_t kMostBranchRays = 65536;  ///< rays of one bounce, all branches together
constexpr std::size_t kManyRays = 1024;     ///< what a call into the tree should bring

/// The widest level of the tree of rays that one start can grow.
double widest_level(int branches, int max_depth) { return std::pow(branches, max_depth); }

}  // namespace

void add(RenderStats& stats, const RenderStats& other) {
  stats.camera_rays += other.camera_rays;
  stats.bounce_rays += other.bounce_rays;
  stats.shadow_rays += other.shadow_rays;
  stats.paths += other.paths;
  stats.non_finite += other.non_finite;
  stats.negative += other.negative;
  stats.truncated += other.truncated;
  stats.closest_calls += other.closest_calls;
  stats.short_calls_while_many_live += other.short_calls_while_many_live;
  stats.traversal.calls += other.traversal.calls;
  stats.traversal.rays += other.traversal.rays;
  stats.traversal.node_steps += other.traversal.node_steps;
  stats.traversal.leaf_visits += other.traversal.leaf_visits;
  stats.traversal.block_tests += other.traversal.block_tests;
}

double rays_of_one_path(int branches, int max_depth) {
  double total = 0.0;
  for (int depth = 0; depth <= max_depth; ++depth) {
    if (branches == 1) return max_depth + 1.0;
    total += std::pow(branches, depth);
    if (!std::isfinite(total)) break;
  }
  return total;
}

struct PathTracer::Scratch {
  PathStream front;  ///< paths whose rays are traced next
  PathStream next;   ///< their continuations
  std::vector<Hit> hits;
  ShadowQueue shadows;
};

PathTracer::PathTracer(const TransportScene& scene, const CameraRays& camera,
                       const PathSettings& settings)
    : scene_(scene), camera_(camera), settings_(settings), scratch_(std::make_unique<Scratch>()) {}

PathTracer::~PathTracer() = default;

// Paths are a queue: continuations go to its end and new starts behind them, so the contributions
// of one start always come in order of (bounce, node), wherever a call is cut. Starts are let in
// as others end, which keeps calls long; with branches, in groups whose trees fit the bound.
bool PathTracer::trace(std::span<const PathStart> starts, std::span<PathResult> results,
                       RenderStats& stats, const std::stop_token& stop) {
  Scratch& scratch = *scratch_;
  PathStream& front = scratch.front;
  PathStream& next = scratch.next;
  front.clear();
  scratch.shadows.clear();
  std::fill(results.begin(), results.end(), PathResult{});
  std::size_t started = 0;

  const auto admit = [&] {
    const double widest = widest_level(settings_.branches, settings_.max_depth);
    const bool branching = settings_.branches > 1 && front.size() > 0;
    const auto room =
        branching ? std::size_t{0}
                  : static_cast<std::size_t>(std::clamp(
                        static_cast<double>(kMostBranchRays) / widest, 1.0,
                        static_cast<double>(kStreamPaths)));
    for (; started < starts.size() && front.size() < room; ++started) {
      const PathStart& start = starts[started];
      const std::uint64_t pixel = (static_cast<std::uint64_t>(start.y) << 32) |
                                  static_cast<std::uint32_t>(start.x);
      PathState state;
      state.key = path_key(settings_.seed, pixel, start.sample);
      state.slot = static_cast<std::uint32_t>(started);
      front.push(camera_.ray(start.x, start.y, settings_.pixel_mode, vertex_key(state.key, 0, 0)),
                 state);
    }
  };

  const auto advance = [&](std::size_t begin, std::size_t end) {
    const std::span<const Ray> rays(front.rays.data() + begin, end - begin);
    scratch.hits.resize(rays.size());
    closest_hits(scene_.tree, rays, scratch.hits, {}, settings_.traversal, &stats.traversal);
    stats.closest_calls += 1;
    stats.short_calls_while_many_live += rays.size() < kManyRays && front.size() >= kManyRays;
    ShadingSinks sinks{results, scratch.shadows, next, stats};
    for (std::size_t i = begin; i < end; ++i) {
      const bool camera_ray = front.states[i].bounce == 0;
      (camera_ray ? stats.camera_rays : stats.bounce_rays) += 1;
      shade_vertex(scene_, settings_, front.rays[i], front.states[i], scratch.hits[i - begin],
                   sinks);
    }
  };

  for (admit(); front.size() > 0; admit()) {
    next.clear();
    const std::size_t calls = std::max<std::size_t>(front.size() / kStreamPaths, 1);
    for (std::size_t call = 0; call < calls; ++call) {
      if (stop.stop_requested()) return false;
      advance(front.size() * call / calls, front.size() * (call + 1) / calls);
    }
    scratch.shadows.flush(scene_.tree, settings_.traversal, results, stats);
    std::swap(front, next);
  }
  stats.paths += starts.size();
  for (const PathResult& result : results) stats.truncated += result.truncated;
  return true;
}

}  // namespace raykiln::render
