#include "raykiln/http/router.hpp"

#include <algorithm>
#include <optional>

namespace raykiln::server {
namespace {

std::vector<std::string> split(std::string_view path) {
  std::vector<std::string> segments;
  while (!path.empty()) {
    path.remove_prefix(1);
    const auto end = std::min(path.find('/'), path.size());
    segments.emplace_back(path.substr(0, end));
    path.remove_prefix(end);
  }
  return segments;
}

bool is_parameter(std::string_view segment) {
  return segment.size() > 2 && segment.front() == '<' && segment.back() == '>';
}

std::optional<std::vector<NamedValue>> match(const Route& route,
                                             const std::vector<std::string>& segments) {
  if (route.segments.size() != segments.size()) return std::nullopt;
  std::vector<NamedValue> parameters;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const std::string& pattern = route.segments[i];
    if (!is_parameter(pattern)) {
      if (pattern != segments[i]) return std::nullopt;
    } else if (segments[i].empty()) {
      return std::nullopt;
    } else {
      parameters.emplace_back(pattern.substr(1, pattern.size() - 2), segments[i]);
    }
  }
  return parameters;
}

void add_once(std::vector<std::string>& list, const std::string& text) {
  if (std::find(list.begin(), list.end(), text) == list.end()) list.push_back(text);
}

}  // namespace

void Router::route(std::string method, std::string pattern, Handler handler,
                   std::size_t max_body_bytes) {
  add({std::move(method), std::move(pattern), std::move(handler), {}, max_body_bytes, {}});
}

void Router::upload(std::string method, std::string pattern, UploadHandler handler) {
  add({std::move(method), std::move(pattern), {}, std::move(handler), 0, {}});
}

void Router::add(Route route) {
  route.segments = split(route.pattern);
  routes_.push_back(std::move(route));
}

std::variant<Match, NoMatch> Router::find(std::string_view method,
                                          const std::vector<std::string>& segments) const {
  const std::string_view wanted = method == "HEAD" ? "GET" : method;
  Match best;
  NoMatch none;
  for (const Route& candidate : routes_) {
    auto parameters = match(candidate, segments);
    if (!parameters) continue;
    add_once(none.allowed_methods, candidate.method);
    if (candidate.method == "GET") add_once(none.allowed_methods, "HEAD");
    const bool better =
        best.route == nullptr || parameters->size() < best.parameters.size();
    if (candidate.method == wanted && better) best = {&candidate, std::move(*parameters)};
  }
  if (best.route != nullptr) return best;
  return none;
}

}  // namespace raykiln::server
