// The route table, with the look of Crow: route("GET", "/v1/jobs/<id>", handler).
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "raykiln/api/message.hpp"

namespace raykiln::server {

using Handler = std::function<Answer(const Request&)>;
using UploadHandler = std::function<UploadStart(const Request&)>;

struct Route {
  std::string method;
  std::string pattern;
  Handler handler;         ///< for whole bodies; exactly one of the two is set
  UploadHandler upload;    ///< for streamed bodies
  std::size_t max_body_bytes = 0;
  std::vector<std::string> segments;  ///< of the pattern; "<name>" matches any non-empty one
};

struct Match {
  const Route* route = nullptr;
  std::vector<NamedValue> parameters;
};

/// No route has this path, or only with the listed methods.
struct NoMatch {
  std::vector<std::string> allowed_methods;  ///< empty: unknown path
};

class Router {
 public:
  /// A handler that gets the body whole, up to `max_body_bytes` (0: no body is taken).
  void route(std::string method, std::string pattern, Handler handler,
             std::size_t max_body_bytes = 0);

  /// A handler that sees the head and says where the body's bytes go.
  void upload(std::string method, std::string pattern, UploadHandler handler);

  /// HEAD finds the route of GET. A literal segment wins over a parameter.
  [[nodiscard]] std::variant<Match, NoMatch> find(std::string_view method,
                                                  const std::vector<std::string>& segments) const;

 private:
  void add(Route route);

  std::vector<Route> routes_;
};

}  // namespace raykiln::server
