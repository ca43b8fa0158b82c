// A small HTTP client that waits: one request, one connection. Beast is used behind this header.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "raykiln/base/result.hpp"

namespace raykiln::server {

struct ServerAddress {
  std::string host;
  std::string port = "80";
};

/// "http://127.0.0.1:8080"; kInvalid when it is no http URL with a host.
[[nodiscard]] Result<ServerAddress> parse_server_url(std::string_view url);

struct ClientResponse {
  int status = 0;
  std::vector<std::pair<std::string, std::string>> headers;
  std::string body;

  /// First value of `name`, however its letters are cased, or null.
  [[nodiscard]] const std::string* header(std::string_view name) const;
};

using ClientHeaders = std::vector<std::pair<std::string, std::string>>;

/// Fills the buffer with the next bytes of a body and gives their number, 0 at its end.
using BodySource = std::function<std::size_t(char* to, std::size_t room)>;

/// Failures are kUnavailable "no_server" (cannot connect, connection lost, silence for too long).
class HttpClient {
 public:
  explicit HttpClient(ServerAddress server,
                      std::chrono::seconds silence = std::chrono::seconds(60));

  [[nodiscard]] Result<ClientResponse> request(const std::string& method, const std::string& target,
                                               const ClientHeaders& headers = {},
                                               const std::string& body = {});

  /// Streams a body of known length; an answer that comes early is taken.
  [[nodiscard]] Result<ClientResponse> upload(const std::string& method, const std::string& target,
                                              const ClientHeaders& headers, std::uint64_t length,
                                              const BodySource& source);

  /// Hands on the body as it arrives until it ends or `take` gives false. The response has a body only
  /// when the status is not 200.
  [[nodiscard]] Result<ClientResponse> stream(const std::string& target, const ClientHeaders& headers,
                                              const std::function<bool(std::string_view)>& take);

 private:
  ServerAddress server_;
  std::chrono::seconds silence_;
};

}  // namespace raykiln::server
