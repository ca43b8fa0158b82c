// Requests of jobs as JSON values, for what has them as a part.
#pragma once

#include <nlohmann/json.hpp>

#include "raykiln/api/problem.hpp"
#include "raykiln/base/config.hpp"
#include "raykiln/jobs/job_request.hpp"

namespace raykiln::server {

[[nodiscard]] nlohmann::ordered_json job_request_value(const JobRequest& request);

/// The fields of POST /v1/jobs; what is wrong goes to `errors`.
[[nodiscard]] JobRequest read_job_request(const nlohmann::json& object, std::string pointer, const JobLimits& limits,
                                          std::vector<FieldError>& errors);

}  // namespace raykiln::server
