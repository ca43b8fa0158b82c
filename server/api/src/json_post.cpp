#include "json_post.hpp"

#include <algorithm>

#include "query.hpp"

namespace raykiln::server {
namespace {

std::optional<Problem> check_idempotency_key(const Request& request) {
  const auto* key = find_value(request.headers, "idempotency-key");
  if (key == nullptr) return std::nullopt;
  const bool visible =
      std::all_of(key->begin(), key->end(), [](char c) { return c > ' ' && c < 0x7F; });
  if (!key->empty() && key->size() <= 200 && visible) return std::nullopt;
  return invalid_parameter("Idempotency-Key", "must have 1 to 200 visible ASCII characters");
}

std::optional<Problem> check_media_type(const Request& request) {
  const auto* type = find_value(request.headers, "content-type");
  const std::string_view text = type == nullptr ? std::string_view{} : *type;
  const auto media = text.substr(0, text.find(';'));
  if (media == "application/json" || media == "application/json ") return std::nullopt;
  return Problem{415, "unsupported_media_type", "Content-Type must be application/json", "Content-Type"};
}

}  // namespace

std::optional<Problem> check_json_post(const Request& request) {
  if (auto problem = check_media_type(request)) return problem;
  return check_idempotency_key(request);
}

}  // namespace raykiln::server
