#include "option_text.hpp"

#include <charconv>
#include <cmath>

namespace raykiln::server {

std::string read_size(const std::string& text, JobRequest& request) {
  const auto* end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, request.width);
  if (first.ec != std::errc{} || first.ptr == end || *first.ptr != 'x') return "--size wants WxH";
  const auto second = std::from_chars(first.ptr + 1, end, request.height);
  if (second.ec != std::errc{} || second.ptr != end) return "--size wants WxH";
  return {};
}

std::optional<Lens> read_lens(const std::string& text) {
  Lens lens;
  const auto* end = text.data() + text.size();
  const auto radius = std::from_chars(text.data(), end, lens.radius);
  if (radius.ec != std::errc{} || radius.ptr == end || *radius.ptr != ',') return std::nullopt;
  const auto focus = std::from_chars(radius.ptr + 1, end, lens.focus_distance);
  if (focus.ec != std::errc{} || focus.ptr != end) return std::nullopt;
  const bool lengths = std::isfinite(lens.radius) && std::isfinite(lens.focus_distance);
  return lengths && lens.radius >= 0.0 && lens.focus_distance > 0.0 ? std::optional(lens) : std::nullopt;
}

std::optional<double> read_error(std::string text) {
  const bool percent = !text.empty() && text.back() == '%';
  if (percent) text.pop_back();
  double value = 0.0;
  const auto* end = text.data() + text.size();
  const auto [stop, fault] = std::from_chars(text.data(), end, value);
  if (fault != std::errc{} || stop != end) return std::nullopt;
  return percent ? value / 100.0 : value;
}

}  // namespace raykiln::server
