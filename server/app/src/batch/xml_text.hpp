#pragma once

#include <string>
#include <string_view>

namespace raykiln::server {

/// Text for XML and HTML, in attributes too. Controls that XML forbids become '?'.
inline std::string xml_text(std::string_view text) {
  std::string result;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '&') result += "&amp;";
    else if (c == '<') result += "&lt;";
    else if (c == '>') result += "&gt;";
    else if (c == '"') result += "&quot;";
    else if (c == '\'') result += "&#39;";
    else if ((byte < 0x20 && c != '\n' && c != '\t') || byte == 0x7F) result += '?';
    else result += c;
  }
  return result;
}

}  // namespace raykiln::server
