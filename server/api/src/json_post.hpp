#pragma once

#include <optional>

#include "raykiln/api/problem.hpp"

namespace raykiln::server {

/// Media type and idempotency key of a request with a JSON body.
[[nodiscard]] std::optional<Problem> check_json_post(const Request& request);

}  // namespace raykiln::server
