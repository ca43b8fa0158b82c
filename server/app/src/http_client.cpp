#include "raykiln/app/http_client.hpp"

#include <array>
#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/buffer_body.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/url/parse.hpp>
#include <boost/url/url_view.hpp>
#include <optional>

namespace raykiln::server {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using asio::ip::tcp;
using boost::system::error_code;

constexpr std::uint64_t kMaxBodyBytes = std::uint64_t{8} << 30U;

Error no_server(const ServerAddress& server, const std::string& reason) {
  return {ErrorKind::kUnavailable, "no_server", reason, server.host + ':' + server.port};
}

/// One connection; every operation waits, at most for the time of silence.
class Line {
 public:
  Line(const ServerAddress& server, std::chrono::seconds silence)
      : server_(server), silence_(silence), stream_(io_) {}

  error_code connect() {
    error_code error;
    tcp::resolver resolver(io_);
    const auto found = resolver.resolve(server_.host, server_.port, error);
    if (error) return error;
    return wait([&](auto done) {
      stream_.async_connect(found, [done](error_code e, const tcp::endpoint&) { done(e); });
    });
  }

  error_code write(std::string_view bytes) {
    return wait([&](auto done) {
      asio::async_write(stream_, asio::buffer(bytes.data(), bytes.size()),
                        [done](error_code e, std::size_t) { done(e); });
    });
  }

  /// Reads a response; its body goes to `take`, which may stop it.
  Result<ClientResponse> read(bool is_head, const std::function<bool(int, std::string_view)>& take) {
    http::response_parser<http::buffer_body> parser;
    parser.body_limit(kMaxBodyBytes);
    parser.skip(is_head);
    error_code error = wait([&](auto done) {
      http::async_read_header(stream_, buffer_, parser, [done](error_code e, std::size_t) { done(e); });
    });
    if (error) return no_server(server_, error.message());
    ClientResponse response;
    response.status = parser.get().result_int();
    for (const auto& field : parser.get().base()) {
      response.headers.emplace_back(field.name_string(), field.value());
    }
    std::array<char, 64 * 1024> piece{};
    while (!parser.is_done()) {
      auto& body = parser.get().body();
      body.data = piece.data();
      body.size = piece.size();
      error = wait([&](auto done) {
        http::async_read_some(stream_, buffer_, parser, [done](error_code e, std::size_t) { done(e); });
      });
      const std::string_view got(piece.data(), piece.size() - body.size);
      if (error == http::error::need_buffer) error = {};
      if (!take(response.status, got)) return response;
      if (error) return no_server(server_, "the connection was lost: " + error.message());
    }
    return response;
  }

 private:
  template <class Start>
  error_code wait(Start start) {
    error_code result;
    stream_.expires_after(silence_);
    start([&result](error_code error) { result = error; });
    io_.restart();
    io_.run();
    return result;
  }

  const ServerAddress& server_;
  std::chrono::seconds silence_;
  asio::io_context io_{1};
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_{256 * 1024};
};

std::string head_text(const ServerAddress& server, const std::string& method,
                      const std::string& target, const ClientHeaders& headers) {
  const bool is_v6 = server.host.find(':') != std::string::npos;
  std::string text = method + ' ' + target + " HTTP/1.1\r\nHost: " +
                     (is_v6 ? '[' + server.host + ']' : server.host) + ':' + server.port +
                     "\r\nUser-Agent: raykiln\r\nConnection: close\r\n";
  for (const auto& [name, value] : headers) text += name + ": " + value + "\r\n";
  return text + "\r\n";
}

std::optional<Error> send_body(Line& line, std::uint64_t length, const BodySource& source) {
  std::array<char, 128 * 1024> piece{};
  while (length > 0) {
    const std::size_t count = source(piece.data(), std::min<std::uint64_t>(piece.size(), length));
    if (count == 0) {
      return Error{ErrorKind::kInternal, "internal", "a file became shorter while it was sent", {}};
    }
    // A server that refuses stops reading: what it says is read next.
    if (line.write({piece.data(), count})) return std::nullopt;
    length -= count;
  }
  return std::nullopt;
}

}  // namespace

Result<ServerAddress> parse_server_url(std::string_view url) {
  const auto parsed = boost::urls::parse_uri(boost::urls::string_view(url.data(), url.size()));
  const Error bad{ErrorKind::kInvalid, "invalid_parameter", "not a URL such as http://127.0.0.1:8080",
                  std::string(url)};
  if (!parsed || parsed->scheme() != "http" || parsed->encoded_host().empty()) return bad;
  ServerAddress server;
  server.host = parsed->host_address();
  if (parsed->has_port()) server.port = parsed->port();
  return server;
}

const std::string* ClientResponse::header(std::string_view name) const {
  for (const auto& [known, value] : headers) {
    if (beast::iequals(known, name)) return &value;
  }
  return nullptr;
}

HttpClient::HttpClient(ServerAddress server, std::chrono::seconds silence)
    : server_(std::move(server)), silence_(silence) {}

Result<ClientResponse> HttpClient::request(const std::string& method, const std::string& target,
                                           const ClientHeaders& headers, const std::string& body) {
  std::size_t sent = 0;
  return upload(method, target, headers, body.size(), [&](char* to, std::size_t room) {
    const std::size_t count = body.copy(to, room, sent);
    sent += count;
    return count;
  });
}

Result<ClientResponse> HttpClient::upload(const std::string& method, const std::string& target,
                                          const ClientHeaders& headers, std::uint64_t length,
                                          const BodySource& source) {
  Line line(server_, silence_);
  if (const auto error = line.connect()) return no_server(server_, error.message());
  ClientHeaders all = headers;
  const bool has_body = method == "POST" || method == "PUT";
  if (has_body) all.emplace_back("Content-Length", std::to_string(length));
  if (const auto error = line.write(head_text(server_, method, target, all))) {
    return no_server(server_, error.message());
  }
  if (auto error = send_body(line, length, source)) return *error;
  std::string body;
  auto response = line.read(method == "HEAD", [&](int, std::string_view piece) {
    body.append(piece);
    return true;
  });
  if (response) response->body = std::move(body);
  return response;
}

Result<ClientResponse> HttpClient::stream(const std::string& target, const ClientHeaders& headers,
                                          const std::function<bool(std::string_view)>& take) {
  Line line(server_, silence_);
  if (const auto error = line.connect()) return no_server(server_, error.message());
  if (const auto error = line.write(head_text(server_, "GET", target, headers))) {
    return no_server(server_, error.message());
  }
  std::string body;
  auto response = line.read(false, [&](int status, std::string_view piece) {
    if (status == 200) return take(piece);
    body.append(piece);
    return true;
  });
  if (response) response->body = std::move(body);
  return response;
}

}  // namespace raykiln::server
