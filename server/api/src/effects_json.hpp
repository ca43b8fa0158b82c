// Effects in JSON, both directions: schemas EffectChoice and EffectReport.
#pragma once

#include <nlohmann/json.hpp>

#include "json_fields.hpp"
#include "raykiln/jobs/effect_report.hpp"
#include "raykiln/jobs/job_request.hpp"

namespace raykiln::server {

/// Reads /effects into JobRequest::effects, in the renderer's spelling and order.
void read_effects(FieldReader& reader, std::vector<FieldError>& errors, JobRequest& request);

/// "auto", "all" or {"without": [...]} from JobRequest::effects.
[[nodiscard]] nlohmann::ordered_json effects_value(const std::string& effects);

/// null until it is known.
[[nodiscard]] nlohmann::ordered_json effect_report_value(const EffectReport& report);

}  // namespace raykiln::server
