#include "tracing.hpp"

namespace raykiln::render {

namespace {

EffectPlan plan_of(const RenderSettings& settings, const Scene& scene, const SceneUse& use) {
  const EffectJob job{.light_model = settings.light_model,
                      .max_depth = path_limit(settings),
                      .emitter_sampling = settings.emitter_sampling};
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
  path.emitter_sampling = settings.emitter_sampling;
  path.bsdf.direction_sampling = settings.direction_sampling;
  path.bsdf.light = settings.light_model;
  path.traversal = settings.traversal;
  const EffectPlan plan = effect_plan(settings, scene);
  path.simulated = plan.simulated;
  path.left_out = plan.approximated();
  return path;
}

CameraRays camera_rays(const PreparedScene& scene, const RenderSettings& settings) {
  return {settings.own_camera ? *settings.own_camera
                              : scene.scene().cameras[static_cast<std::size_t>(settings.camera)],
          settings.width, settings.height, bounds(scene.tree())};
}

}  // namespace raykiln::render
