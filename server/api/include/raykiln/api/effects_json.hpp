// What is simulated, and why, as JSON.
#pragma once

#include <string>

#include "raykiln/jobs/effect_report.hpp"

namespace raykiln::server {

/// Schema EffectReport, on one line.
[[nodiscard]] std::string effect_report_json(const EffectReport& report);

}  // namespace raykiln::server
