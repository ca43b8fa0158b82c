#include "raykiln/render/replay.hpp"

#include "tracing.hpp"

namespace raykiln::render {

ReplayedSample replay_sample(const PreparedScene& scene, const RenderSettings& settings, int x,
                             int y, std::uint64_t sample) {
  const CameraRays camera = camera_rays(scene, settings);
  PathTracer tracer(transport_scene(scene), camera,
                    path_settings(scene, settings));
  const PathStart start{x, y, sample};
  PathResult path;
  ReplayedSample result;
  // Never stopped: one sample is at most kMostRaysOfPath rays.
  static_cast<void>(tracer.trace(std::span(&start, 1), std::span(&path, 1), result.stats, {}));
  result.radiance = path.radiance();
  result.truncated = path.truncated;
  PlaneSet planes = make_block_planes(1);
  result.dropped = !add_sample(planes, 0, result.radiance, path.truncated);
  return result;
}

}  // namespace raykiln::render
