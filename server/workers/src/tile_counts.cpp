#include "raykiln/workers/tile_counts.hpp"

namespace raykiln::server {

void add_counts(JobStatistics& sum, const render::TileResult& result) {
  const render::RenderStats& counted = result.stats;
  sum.paths += counted.paths;
  sum.camera_rays += counted.camera_rays;
  sum.bounce_rays += counted.bounce_rays;
  sum.shadow_rays += counted.shadow_rays;
  sum.non_finite += counted.non_finite;
  sum.negative += counted.negative;
  sum.truncated += counted.truncated;
  sum.roulette_ends += counted.roulette_ends;
  sum.lights_at_hits += counted.lights_at_hits;
  sum.stream_calls += counted.closest_calls;
  sum.short_stream_calls += counted.short_calls_while_many_live;
  sum.traversal_seconds += counted.traversal_seconds;
  sum.shading_seconds += counted.shading_seconds;
  for (const render::BadSample& bad : result.bad_samples) {
    if (sum.bad_samples.size() >= kMaxLocatedSamples) return;
    sum.bad_samples.push_back({bad.x, bad.y, bad.sample});
  }
}

}  // namespace raykiln::server
