#include "rows.hpp"
#include "sources.hpp"

namespace raykiln::render {
namespace {

Judgement judge(const EffectView& view) {
  if (!(view.job.lens_radius > 0.0)) return {false, "the camera is a pinhole"};
  if (!has_light(view)) return {false, "there is no light in the scene"};
  return {true, "the camera's lens has a radius of " + shortest(view.job.lens_radius) + " m"};
}

void provoke(const EffectExample& at) {
  at.job.lens_radius = 0.02;
  for (Camera& camera : at.scene.cameras) camera.lens = {.radius = at.job.lens_radius, .focus_distance = 0.7};
}

}  // namespace

const EffectRow kDepthOfFieldRow{.effect = Effect::kDepthOfField,
                                 .name = "depth_of_field",
                                 .left_out = "drawing points of the lens: everything is as sharp as through its middle",
                                 .grade = Grade::kUnbounded,
                                 .judge = judge,
                                 .provoke = provoke};

}  // namespace raykiln::render
