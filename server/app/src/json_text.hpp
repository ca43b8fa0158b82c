// Strings of the small JSON that the CLI writes by itself.
#pragma once

#include <cstdio>
#include <string>
#include <string_view>

namespace raykiln::server {

/// `text` (valid UTF-8) as a JSON string, with quotes.
inline std::string json_string(std::string_view text) {
  std::string result(1, '"');
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    if (static_cast<unsigned char>(c) < 0x20) {
      char escaped[8];
      std::snprintf(escaped, sizeof escaped, "\\u%04x", static_cast<unsigned>(c));
      result += escaped;
    } else {
      result += c;
    }
  }
  result += '"';
  return result;
}

}  // namespace raykiln::server
