#pragma once

#include <nlohmann/json.hpp>

#include "raykiln/jobs/job_request.hpp"

namespace raykiln::server {

[[nodiscard]] nlohmann::ordered_json job_request_value(const JobRequest& request);

}  // namespace raykiln::server
