// Errors on the wire: RFC 9457, codes as listed in proto/openapi.yaml.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "raykiln/api/message.hpp"
#include "raykiln/base/result.hpp"

namespace raykiln::server {

/// One wrong field of a JSON request.
struct FieldError {
  std::string pointer;  ///< RFC 6901
  std::string code;     ///< unknown_field, missing_field, wrong_type, out_of_range, ...
  std::string detail;
};

struct Problem {
  int status = 500;
  std::string code = "internal";
  std::string detail;
  std::string where{};
  std::vector<FieldError> errors{};
  std::optional<int> retry_after_s{};
};

/// Reason phrase of a status code.
[[nodiscard]] std::string_view reason_phrase(int status);

/// The status follows from the kind; an internal error's text stays in the log.
[[nodiscard]] Problem problem_of(const Error& error);

[[nodiscard]] std::string problem_json(const Problem& problem);
[[nodiscard]] Response to_response(const Problem& problem);

}  // namespace raykiln::server
