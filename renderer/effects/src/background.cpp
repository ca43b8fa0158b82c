#include "rows.hpp"
#include "sources.hpp"

namespace raykiln::render {
namespace {

Judgement judge(const EffectView& view) {
  if (is_black(view.scene.background)) return {false, "the background is black"};
  return {true, "background " + text(view.scene.background)};
}

void provoke(const EffectExample& at) { at.scene.background = {0.2F, 0.3F, 0.5F}; }

}  // namespace

const EffectRow kBackgroundRow{.effect = Effect::kBackground,
                               .name = "background",
                               .left_out = "the light of rays that meet nothing",
                               .grade = Grade::kBounded,
                               .judge = judge,
                               .provoke = provoke};

}  // namespace raykiln::render
