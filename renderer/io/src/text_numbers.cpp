#include "text_numbers.hpp"

#include <charconv>
#include <cmath>

namespace raykiln::render::io {
namespace {

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

// from_chars says "out of range" for both ends. Too small: a negative exponent, or 0.000...
bool is_tiny(std::string_view word) {
  return word.find("e-") != std::string_view::npos || word.find("E-") != std::string_view::npos ||
         word.substr(0, 1) == "." || word.substr(0, 2) == "0." || word.substr(0, 2) == "-." ||
         word.substr(0, 3) == "-0.";
}

}  // namespace

void skip_spaces(std::string_view& text) {
  std::size_t n = 0;
  while (n < text.size() && is_space(text[n])) ++n;
  text.remove_prefix(n);
}

std::string_view take_word(std::string_view& text) {
  skip_spaces(text);
  std::size_t n = 0;
  while (n < text.size() && !is_space(text[n])) ++n;
  const std::string_view word = text.substr(0, n);
  text.remove_prefix(n);
  return word;
}

NumberStatus take_number(std::string_view& text, double& value) {
  skip_spaces(text);
  if (text.empty() || text[0] == '#') return NumberStatus::kMissing;
  const std::size_t sign = text[0] == '+' && text.size() > 1 && text[1] != '-' ? 1 : 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data() + sign, end, value);
  if (error == std::errc::invalid_argument) return NumberStatus::kMalformed;
  if (stop != end && !is_space(*stop)) return NumberStatus::kMalformed;
  const std::string_view word = text.substr(sign, static_cast<std::size_t>(stop - text.data()) - sign);
  text.remove_prefix(static_cast<std::size_t>(stop - text.data()));
  if (error == std::errc::result_out_of_range) {
    value = 0.0;
    return is_tiny(word) ? NumberStatus::kOk : NumberStatus::kNotFinite;
  }
  return std::isfinite(value) ? NumberStatus::kOk : NumberStatus::kNotFinite;
}

bool take_integer(std::string_view& text, std::int64_t& value) {
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc()) return false;
  text.remove_prefix(static_cast<std::size_t>(stop - text.data()));
  return true;
}

std::string_view trimmed(std::string_view text) {
  skip_spaces(text);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return text;
}

}  // namespace raykiln::render::io
