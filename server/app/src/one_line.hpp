// Text of strangers (paths, keys, names in files) on a terminal or in a log.
#pragma once

#include <algorithm>
#include <string>

namespace raykiln::server {

/// Controls become blanks: else a name could move the cursor, or begin a line that a CI service takes for a command.
[[nodiscard]] inline std::string one_line(std::string text) {
  std::replace_if(text.begin(), text.end(),
                  [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; }, ' ');
  return text;
}

/// At most so many bytes of UTF-8, cut between characters.
[[nodiscard]] inline std::string cut_to(std::string text, std::size_t most) {
  if (text.size() <= most) return text;
  while (most > 0 && (static_cast<unsigned char>(text[most]) & 0xC0U) == 0x80U) --most;
  text.resize(most);
  return text;
}

}  // namespace raykiln::server
