// Query and path parameters, checked: unknown, repeated and impossible ones are refused.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>

#include "raykiln/api/message.hpp"
#include "raykiln/api/problem.hpp"

namespace raykiln::server {

/// The first parameter that is not in `known`, or that comes twice.
[[nodiscard]] std::optional<Problem> check_query(const Request& request,
                                                 std::initializer_list<std::string_view> known);

[[nodiscard]] Problem invalid_parameter(std::string name, std::string detail);

/// `fallback` when absent; nothing when it is no integer in [least, most].
[[nodiscard]] std::optional<std::uint64_t> query_natural(const Request& request,
                                                         std::string_view name, std::uint64_t least,
                                                         std::uint64_t most, std::uint64_t fallback);

/// A decimal number such as -1.5; `fallback` when absent.
[[nodiscard]] std::optional<double> query_number(const Request& request, std::string_view name,
                                                 double least, double most, double fallback);

/// Empty when absent.
[[nodiscard]] std::string query_text(const Request& request, std::string_view name);

/// The scene id of the path, or why it is none.
[[nodiscard]] std::optional<Problem> check_scene_id(const Request& request);
[[nodiscard]] std::optional<Problem> check_job_id(const Request& request);
[[nodiscard]] std::string path_parameter(const Request& request, std::string_view name);

[[nodiscard]] Response json_response(int status, std::string json);
[[nodiscard]] Response json_response(int status, SharedBytes json);

}  // namespace raykiln::server
