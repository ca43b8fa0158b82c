#include "query.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "raykiln/base/ids.hpp"

namespace raykiln::server {

std::optional<Problem> check_query(const Request& request,
                                   std::initializer_list<std::string_view> known) {
  for (const auto& [name, value] : request.query) {
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      return Problem{400, "unknown_parameter", "this operation has no such parameter", name};
    }
    const auto times = std::count_if(request.query.begin(), request.query.end(),
                                     [&](const auto& other) { return other.first == name; });
    if (times > 1) return invalid_parameter(name, "given twice");
  }
  return std::nullopt;
}

Problem invalid_parameter(std::string name, std::string detail) {
  return {400, "invalid_parameter", std::move(detail), std::move(name)};
}

std::optional<std::uint64_t> query_natural(const Request& request, std::string_view name,
                                           std::uint64_t least, std::uint64_t most,
                                           std::uint64_t fallback) {
  const auto* text = find_value(request.query, name);
  if (text == nullptr) return fallback;
  std::uint64_t value = 0;
  const auto* end = text->data() + text->size();
  const auto [stop, error] = std::from_chars(text->data(), end, value);
  if (error != std::errc{} || stop != end || value < least || value > most) return std::nullopt;
  return value;
}

std::optional<double> query_number(const Request& request, std::string_view name, double least,
                                   double most, double fallback) {
  const auto* text = find_value(request.query, name);
  if (text == nullptr) return fallback;
  double value = 0.0;
  const auto* end = text->data() + text->size();
  const auto [stop, error] = std::from_chars(text->data(), end, value);
  if (error != std::errc{} || stop != end || !(value >= least && value <= most)) return std::nullopt;
  return value;
}

std::string query_text(const Request& request, std::string_view name) {
  const auto* text = find_value(request.query, name);
  return text == nullptr ? std::string() : *text;
}

std::string path_parameter(const Request& request, std::string_view name) {
  const auto* text = find_value(request.path_parameters, name);
  return text == nullptr ? std::string() : *text;
}

std::optional<Problem> check_scene_id(const Request& request) {
  if (is_sha256_hex(path_parameter(request, "scene"))) return std::nullopt;
  return invalid_parameter("scene", "a scene id has 64 lower-case hexadecimal digits");
}

std::optional<Problem> check_job_id(const Request& request) {
  if (is_plain_id(path_parameter(request, "job"), 64)) return std::nullopt;
  return invalid_parameter("job", "a job id has 1 to 64 letters, digits, - or _");
}

Response json_response(int status, std::string json) {
  return json_response(status, std::make_shared<const std::string>(std::move(json)));
}

Response json_response(int status, SharedBytes json) {
  Response response;
  response.status = status;
  response.content_type = "application/json";
  response.headers.emplace_back("Cache-Control", "no-store");
  response.body = std::move(json);
  return response;
}

}  // namespace raykiln::server
