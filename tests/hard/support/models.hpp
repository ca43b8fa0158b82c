// Both light models, and settings of small pictures in one of them.
#pragma once

#include <array>
#include <optional>

#include "raykiln/render/render.hpp"

namespace raykiln::hard {

inline constexpr std::array<render::LightModel, 2> kBothModels{render::kPhysicalModel,
                                                               render::kSeedModel};

/// Members take turns: the even ones are rendered in the physical model.
inline const render::LightModel& model_of(std::size_t member) { return kBothModels[member % 2]; }

/// The model without roulette: every path runs to the depth.
inline render::LightModel fixed_depth(render::LightModel model) {
  model.roulette = false;
  return model;
}

inline render::RenderSettings square_settings(int side, std::optional<int> max_depth,
                                              const render::LightModel& model) {
  render::RenderSettings settings;
  settings.width = settings.height = side;
  settings.max_depth = max_depth;
  settings.light_model = model;
  return settings;
}

}  // namespace raykiln::hard
