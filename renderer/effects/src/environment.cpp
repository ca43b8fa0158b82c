#include <memory>

#include "raykiln/scene/environment_map.hpp"
#include "rows.hpp"
#include "sources.hpp"

namespace raykiln::render {
namespace {

Judgement judge(const EffectView& view) {
  if (view.scene.environment == nullptr) return {false, "there is no environment map"};
  if (!view.use.environment_shines) return {false, "the environment map is black"};
  const EnvironmentMap& map = *view.scene.environment;
  return {true, "environment map of " + std::to_string(map.width) + " x " +
                    std::to_string(map.height)};
}

void provoke(const EffectExample& at) {
  EnvironmentMap map{.name = "example", .width = 4, .height = 2, .rgb = {}, .rotation_rad = 0.4};
  for (int i = 0; i < 3 * map.width * map.height; ++i) {
    map.rgb.push_back(0.05F * static_cast<float>(i % 7));
  }
  at.scene.environment = std::make_shared<const EnvironmentMap>(std::move(map));
}

}  // namespace

const EffectRow kEnvironmentRow{.effect = Effect::kEnvironment,
                       .name = "environment",
                       .left_out = "looking the map up for rays that meet nothing, sending rays to it",
                       .grade = Grade::kBounded,
                       .judge = judge,
                       .provoke = provoke};

}  // namespace raykiln::render
