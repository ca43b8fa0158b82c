// Problems inside other JSON, on both sides of the wire.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "raykiln/api/problem.hpp"

namespace raykiln::server {

[[nodiscard]] nlohmann::ordered_json problem_value(const Problem& problem);
/// Null for none.
[[nodiscard]] nlohmann::ordered_json error_value(const std::optional<Error>& error);

/// "code: detail (where)". Throws json::exception when it is no problem.
[[nodiscard]] std::string error_text(const nlohmann::json& problem);

}  // namespace raykiln::server
