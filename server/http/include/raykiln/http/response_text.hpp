// The head of an answer as text.
#pragma once

#include <chrono>
#include <string>
#include <string_view>

#include "raykiln/api/message.hpp"

namespace raykiln::server {

struct ResponseFraming {
  bool keep_alive = true;
  bool http_1_0 = false;
  bool until_close = false;  ///< no length: the body ends with the connection (event streams)
  std::string_view request_id;
  std::chrono::system_clock::time_point now;
};

/// Status line and headers with the empty line: those of the response, framing, Date, X-Request-Id and
/// the ones that keep other sites out. Control characters in a value are left out.
[[nodiscard]] std::string response_head(const Response& response, const ResponseFraming& framing);

}  // namespace raykiln::server
