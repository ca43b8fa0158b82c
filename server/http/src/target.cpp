#include "raykiln/http/target.hpp"

#include <algorithm>
#include <boost/url/parse.hpp>
#include <boost/url/url_view.hpp>

#include "raykiln/api/percent.hpp"

namespace raykiln::server {
namespace {

bool has_control(std::string_view text) {
  return std::any_of(text.begin(), text.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte < 0x20 || byte == 0x7F;
  });
}

/// In a query, browsers and most clients write a space as '+' (and a plus as %2B).
std::optional<std::string> decode_form(std::string_view text) {
  std::string spaced(text);
  std::replace(spaced.begin(), spaced.end(), '+', ' ');
  return percent_decode(spaced);
}

bool is_safe_segment(std::string_view segment) {
  return segment != "." && segment != ".." && !has_control(segment) &&
         segment.find_first_of("/\\") == std::string_view::npos;
}

}  // namespace

std::optional<Target> parse_target(std::string_view text) {
  if (!text.starts_with('/')) return std::nullopt;
  const auto url = boost::urls::parse_origin_form(boost::urls::string_view(text.data(), text.size()));
  if (!url) return std::nullopt;

  Target target;
  std::string_view path = text.substr(0, text.find('?'));
  while (!path.empty()) {
    path.remove_prefix(1);  // the slash
    const auto end = std::min(path.find('/'), path.size());
    auto segment = percent_decode(path.substr(0, end));
    if (!segment || !is_safe_segment(*segment)) return std::nullopt;
    if (target.segments.size() == kMaxSegments) return std::nullopt;
    target.path += '/' + *segment;
    target.segments.push_back(std::move(*segment));
    path.remove_prefix(end);
  }
  for (const auto& parameter : url->encoded_params()) {
    auto name = decode_form({parameter.key.data(), parameter.key.size()});
    auto value = decode_form({parameter.value.data(), parameter.value.size()});
    if (!name || !value || has_control(*name) || has_control(*value)) return std::nullopt;
    if (target.query.size() == kMaxQueryParameters) return std::nullopt;
    target.query.emplace_back(std::move(*name), std::move(*value));
  }
  return target;
}

}  // namespace raykiln::server
