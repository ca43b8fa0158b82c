#include "tracing.hpp"

namespace raykiln::render {

PathSettings path_settings(const RenderSettings& settings) {
  PathSettings path;
  path.seed = settings.seed;
  path.max_depth = path_limit(settings);
  path.branches = settings.branches;
  path.pixel_mode = settings.pixel_mode;
  path.emitter_sampling = settings.emitter_sampling;
  path.bsdf.direction_sampling = settings.direction_sampling;
  path.bsdf.light = settings.light_model;
  path.traversal = settings.traversal;
  return path;
}

CameraRays camera_rays(const PreparedScene& scene, const RenderSettings& settings) {
  return {settings.own_camera ? *settings.own_camera
                              : scene.scene().cameras[static_cast<std::size_t>(settings.camera)],
          settings.width, settings.height, bounds(scene.tree())};
}

}  // namespace raykiln::render
