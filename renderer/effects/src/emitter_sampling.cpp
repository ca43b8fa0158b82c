#include <algorithm>

#include "rows.hpp"
#include "sources.hpp"

namespace raykiln::render {
namespace {

Judgement judge(const EffectView& view) {
  const bool emitters = emitting_material(view) != nullptr;
  if (!emitters && !view.use.environment_shines)
    return {false, "no triangle has a material with emission above 0, and no environment shines"};
  if (reflecting_material(view) == nullptr) return {false, "no surface reflects"};
  if (!view.job.emitter_sampling) return {false, "the job has emitter_sampling false"};
  if (view.job.max_depth < 1) return {false, "max_depth 0: emitters are only seen directly"};
  return {true, emitters ? "emitters light reflecting surfaces"
                         : "the environment lights reflecting surfaces"};
}

void provoke(const EffectExample& at) {
  row_of(Effect::kAreaEmitters).provoke(at);
  at.job.emitter_sampling = true;
  at.job.max_depth = std::max(at.job.max_depth, 1);
}

}  // namespace

const EffectRow kEmitterSamplingRow{.effect = Effect::kEmitterSampling,
                                    .name = "emitter_sampling",
                                    .left_out =
                                        "drawing points on emitters and directions to the "
                                        "environment, their shadow rays and the weights "
                                        "between both ways to such light",
                                    .grade = Grade::kUnbiased,
                                    .judge = judge,
                                    .provoke = provoke};

}  // namespace raykiln::render
