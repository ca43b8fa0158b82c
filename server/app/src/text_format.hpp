// Numbers in the small texts that the CLI writes by itself.
#pragma once

#include <array>
#include <cmath>
#include <cstdio>
#include <string>

namespace raykiln::server {

/// For people: three digits.
inline std::string short_number(double value) {
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%.3g", value);
  return text.data();
}

/// For programs: nine digits; JSON has no NaN and no infinity, so those are null.
inline std::string json_number(double value) {
  if (!std::isfinite(value)) return "null";
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%.9g", value);
  return text.data();
}

}  // namespace raykiln::server
