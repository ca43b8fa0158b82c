// The renderer's plan of effects in the words of the API.
#pragma once

#include "raykiln/effects/effect_plan.hpp"
#include "raykiln/jobs/effect_report.hpp"

namespace raykiln::server {

[[nodiscard]] EffectReport effect_report(const render::EffectPlan& plan);

}  // namespace raykiln::server
