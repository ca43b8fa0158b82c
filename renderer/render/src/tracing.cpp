#include "tracing.hpp"

#include "raykiln/integrator/make_ready.hpp"

namespace raykiln::render {

namespace {

/// 0 without a camera: a scene that is put together by hand may have none when it is asked for effects.
double lens_radius(const RenderSettings& settings, const Scene& scene) {
  const bool none = !settings.own_camera && static_cast<std::size_t>(settings.camera) >= scene.cameras.size();
  return none ? 0.0 : camera_of(settings, scene).lens.radius;
}

EffectPlan plan_of(const RenderSettings& settings, const Scene& scene, const SceneUse& use) {
  const EffectJob job{.light_model = settings.light_model,
                      .max_depth = path_limit(settings),
                      .emitter_sampling = settings.emitter_sampling,
                      .lens_radius = lens_radius(settings, scene)};
  return plan_effects(scene, use, job, settings.effects);
}

}  // namespace

EffectPlan effect_plan(const RenderSettings& settings, const Scene& scene) {
  return plan_of(settings, scene, use_of(scene));
}

EffectPlan effect_plan(const RenderSettings& settings, const PreparedScene& scene) {
  return plan_of(settings, scene.scene(), scene.use());
}

PathSettings path_settings(const PreparedScene& scene, const RenderSettings& settings) {
  PathSettings path;
  path.seed = settings.seed;
  path.sampler = settings.sampler;
  path.max_depth = path_limit(settings);
  path.branches = settings.branches;
  path.pixel_mode = settings.pixel_mode;
  path.pixel_filter = settings.pixel_filter;
  if (settings.crop) {
    path.window_x = settings.crop->x;
    path.window_y = settings.crop->y;
  }
  path.emitter_sampling = settings.emitter_sampling;
  path.emitter_choice = settings.emitter_choice;
  path.texture_reading = settings.texture_reading;
  path.bsdf.direction_sampling = settings.direction_sampling;
  path.bsdf.light = settings.light_model;
  path.traversal = settings.traversal;
  const EffectPlan plan = effect_plan(settings, scene);
  path.simulated = plan.simulated;
  path.left_out = plan.approximated();
  return path;
}

CameraRays camera_rays(const PreparedScene& scene, const RenderSettings& settings) {
  Camera camera = camera_of(settings, scene.scene());
  const bool lens = camera.lens.radius > 0.0;
  if (lens && !effect_plan(settings, scene).simulated.contains(Effect::kDepthOfField)) camera.lens.radius = 0.0;
  const Bounds3f geometry = bounds(scene.tree());
  if (!settings.crop) return {camera, settings.width, settings.height, geometry};
  return {camera, settings.crop->full_width, settings.crop->full_height, geometry};
}

TransportScene transport_scene(const PreparedScene& scene) {
  return {scene.scene(), scene.tree(), scene.emitters(), &scene.pyramids(), scene.casters()};
}

bool make_ready(const PreparedScene& scene, const RenderSettings& settings, const std::stop_token& stop) {
  return make_ready(transport_scene(scene), path_settings(scene, settings), stop);
}

}  // namespace raykiln::render
