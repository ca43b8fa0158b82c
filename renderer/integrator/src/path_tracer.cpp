#include "raykiln/integrator/path_tracer.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "axis_group.hpp"
#include "camera_group.hpp"
#include "first_surface.hpp"
#include "matte_group.hpp"
#include "gap_walk.hpp"
#include "path_stream.hpp"
#include "shadow_queue.hpp"
#include "vertex_shading.hpp"

namespace raykiln::render {
namespace {

constexpr std::size_t kStreamPaths = 2048;      ///< paths kept under way while there are so many
constexpr std::size_t kMostBranchRays = 65536;  ///< rays of one bounce, all branches together
constexpr std::size_t kManyRays = 1024;         ///< what a call into the tree should bring

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// What every path brings where there is nothing to meet: no ray is needed.
void fill_with_background(std::span<PathResult> results, const Rgb& background) {
  for (PathResult& result : results) result.emitted = Rgbd(background);
}

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
  stats.lights_at_hits += other.lights_at_hits;
  stats.truncated += other.truncated;
  stats.roulette_ends += other.roulette_ends;
  stats.gap_rays += other.gap_rays;
  stats.closest_calls += other.closest_calls;
  stats.short_calls_while_many_live += other.short_calls_while_many_live;
  stats.lane_camera_rays += other.lane_camera_rays;
  stats.lane_mattes += other.lane_mattes;
  stats.lane_axes += other.lane_axes;
  stats.traversal_seconds += other.traversal_seconds;
  stats.shading_seconds += other.shading_seconds;
  stats.traversal += other.traversal;
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
  Transport transport;
  ShadingLoop loop;  ///< the instance for what is simulated
  PathStream front;  ///< paths whose rays are traced next
  PathStream next;   ///< their continuations
  std::vector<Hit> hits;
  ShadowQueue shadows;
  MatteGroup mattes;
  AxisGroup axes;
  CameraGroup cameras;
  Material painted{};  ///< for layers
  GapWalk gaps{};
};

/// One call of trace().
struct PathTracer::Call {
  std::span<const PathStart> starts;
  std::span<PathResult> results;
  RenderStats& stats;
  const std::stop_token& stop;
  std::span<LayerSample> layers;
  std::size_t started = 0;  ///< starts whose camera ray has been shot
};

PathTracer::PathTracer(const TransportScene& scene, const CameraRays& camera,
                       const PathSettings& settings)
    : camera_(camera) {
  const Transport transport = make_transport(scene, settings);
  scratch_.reset(new Scratch{transport, render::shading_loop(switches_for(transport)), {}, {}, {}, {},
                             MatteGroup(transport), AxisGroup(transport), CameraGroup(camera, settings), {}});
}

PathTracer::~PathTracer() = default;

std::string_view PathTracer::shading_loop() const { return scratch_->loop.name; }

void PathTracer::admit(Call& call) {
  PathStream& front = scratch_->front;
  const PathSettings& settings = scratch_->transport.settings;
  if (settings.branches > 1 && front.size() > 0) return;
  const double widest = widest_level(settings.branches, settings.max_depth);
  const auto room = static_cast<std::size_t>(std::clamp(
      static_cast<double>(kMostBranchRays) / widest, 1.0, static_cast<double>(kStreamPaths)));
  if (front.size() >= room) return;
  const std::size_t count = std::min(room - front.size(), call.starts.size() - call.started);
  const std::span<const PathStart> starts = call.starts.subspan(call.started, count);
  const auto first_slot = static_cast<std::uint32_t>(call.started);
  if (scratch_->cameras.ready()) {
    scratch_->cameras.shoot(starts, first_slot, front);
    call.stats.lane_camera_rays += count;
  } else {
    shoot(starts, first_slot, front);
  }
  call.started += count;
  if (scratch_->transport.emitters_by_tree) front.origins.resize(front.size());
  if (scratch_->transport.pyramids == nullptr) return;
  while (front.cones.size() < front.size()) front.cones.push_back(camera_.cone(front.rays()[front.cones.size()]));
}

void PathTracer::shoot(std::span<const PathStart> starts, std::uint32_t first_slot, PathStream& into) const {
  const PathSettings& settings = scratch_->transport.settings;
  for (std::size_t i = 0; i < starts.size(); ++i) {
    const int x = starts[i].x + settings.window_x, y = starts[i].y + settings.window_y;
    const std::uint64_t pixel = (static_cast<std::uint64_t>(y) << 32) | static_cast<std::uint32_t>(x);
    PathState state;
    state.key = path_key(settings.sampler, settings.seed, pixel, starts[i].sample);
    state.slot = first_slot + static_cast<std::uint32_t>(i);
    into.push(camera_.ray(x, y, settings.pixel_mode, vertex_key(state.key, 0, 0), settings.pixel_filter), state);
  }
}

void PathTracer::advance(Call& call, std::size_t begin, std::size_t end) {
  Scratch& scratch = *scratch_;
  PathStream& front = scratch.front;
  const std::span<const Ray> rays = front.rays().subspan(begin, end - begin);
  scratch.hits.resize(rays.size());
  const Clock::time_point start = Clock::now();
  closest_hits(scratch.transport.tree, rays, scratch.hits, {}, scratch.transport.settings.traversal,
               &call.stats.traversal, {.from = front.from().subspan(begin, end - begin)});
  if (scratch.transport.gaps.any()) {
    scratch.gaps.paths(scratch.transport, rays,
                       scratch.front.states().subspan(begin, end - begin), scratch.hits,
                       call.results, call.stats);
  }
  call.stats.traversal_seconds += seconds_since(start);
  call.stats.closest_calls += 1;
  call.stats.short_calls_while_many_live += rays.size() < kManyRays && front.size() >= kManyRays;
  if (!call.layers.empty()) look(call, begin, end);
  shade(call, begin, end);
  if (call.layers.empty()) return;
  mark_light(scratch.transport, front.states().subspan(begin, end - begin), call.results, call.layers);
}

void PathTracer::look(Call& call, std::size_t begin, std::size_t end) {
  Scratch& scratch = *scratch_;
  for (std::size_t i = begin; i < end; ++i) {
    const PathState& state = scratch.front.states()[i];
    if (state.bounce > 0) continue;
    call.layers[state.slot] =
        first_surface(scratch.transport, camera_, scratch.front.rays()[i], scratch.hits[i - begin], scratch.painted);
  }
}

void PathTracer::dark(Call& call) {
  fill_with_background(call.results, scratch_->transport.background);
  if (call.layers.empty()) return;
  std::fill(call.layers.begin(), call.layers.end(), LayerSample{});
  Scratch& scratch = *scratch_;
  const bool surfaces = !bounds(scratch.transport.tree).empty();
  for (admit(call); surfaces && scratch.front.size() > 0 && !call.stop.stop_requested(); admit(call)) {
    scratch.hits.resize(scratch.front.size());
    closest_hits(scratch.transport.tree, scratch.front.rays(), scratch.hits, {}, scratch.transport.settings.traversal,
                 &call.stats.traversal);
    if (scratch.transport.gaps.any()) {
      scratch.gaps.paths(scratch.transport, scratch.front.rays(), scratch.front.states(), scratch.hits, call.results,
                         call.stats);
    }
    call.stats.camera_rays += scratch.front.size();
    look(call, 0, scratch.front.size());
    scratch.front.clear();
  }
  for (std::size_t i = 0; i < call.results.size(); ++i) call.layers[i].emission = call.results[i].emitted;
}

void PathTracer::shade(Call& call, std::size_t begin, std::size_t end) {
  Scratch& scratch = *scratch_;
  RenderStats& stats = call.stats;
  const Clock::time_point start = Clock::now();
  const double traversal_before = stats.traversal_seconds;
  ShadingSinks sinks{call.results, scratch.shadows, scratch.next, stats, call.stop, {}};
  scratch.loop.run(scratch.transport, {scratch.front, scratch.hits, begin, end, scratch.mattes, scratch.axes}, sinks);
  scratch.shadows.flush(scratch.transport.tree, scratch.transport.settings.traversal, call.results,
                        stats, scratch.transport.gaps);
  stats.shading_seconds += seconds_since(start) - (stats.traversal_seconds - traversal_before);
}

// Paths are a queue: continuations go to its end and new starts behind them, so the contributions
// of one start always come in order of (bounce, node), wherever a call is cut. Starts are let in
// as others end, which keeps calls long; with branches, in groups whose trees fit the bound.
bool PathTracer::trace(std::span<const PathStart> starts, std::span<PathResult> results,
                       RenderStats& stats, const std::stop_token& stop, std::span<LayerSample> layers) {
  Scratch& scratch = *scratch_;
  scratch.front.clear();
  scratch.shadows.clear();
  std::fill(results.begin(), results.end(), PathResult{});
  const bool no_surface =
      bounds(scratch.transport.tree).empty() && scratch.transport.environment == nullptr;
  if (no_surface || !scratch.transport.has_light) {
    Call call{starts, results, stats, stop, layers};
    dark(call);
    stats.paths += starts.size();
    return !stop.stop_requested();
  }
  Call call{starts, results, stats, stop, layers};
  for (admit(call); scratch.front.size() > 0; admit(call)) {
    scratch.next.clear();
    const std::size_t live = scratch.front.size();
    const std::size_t calls = std::max<std::size_t>(live / kStreamPaths, 1);
    for (std::size_t i = 0; i < calls; ++i) {
      if (stop.stop_requested()) return false;
      advance(call, live * i / calls, live * (i + 1) / calls);
    }
    std::swap(scratch.front, scratch.next);
  }
  if (!layers.empty()) divide_light(results, layers);
  stats.paths += starts.size();
  for (const PathResult& result : results) stats.truncated += result.truncated;
  return true;
}

}  // namespace raykiln::render
