// One connection: read a head, decide, read the body, run the handler, answer; again.
#include <boost/asio/as_tuple.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <exception>
#include <optional>

#include "connection.hpp"
#include "off_thread.hpp"
#include "raykiln/api/problem.hpp"
#include "raykiln/http/body_decoder.hpp"
#include "raykiln/http/head.hpp"
#include "raykiln/http/response_text.hpp"
#include "raykiln/http/target.hpp"
#include "raykiln/http/upload_body.hpp"

namespace raykiln::server {
namespace {

namespace asio = boost::asio;

constexpr std::size_t kReadPiece = 16 * 1024;
constexpr std::size_t kUploadPiece = 128 * 1024;
constexpr std::size_t kLingerBytes = 16 * 1024 * 1024;
constexpr auto kLingerTime = std::chrono::seconds(3);

/// What one exchange has come to so far.
struct Exchange {
  RequestHead head;
  Request request;
  const Route* route = nullptr;
  bool keep_alive = true;
  bool body_unread = false;  ///< the peer may still be sending: linger before closing
  SteadyTime begun{};
  std::size_t sent = 0;
};

// g++ 12 destroys aggregate temporaries of an expression with co_await twice, and evaluates co_await
// behind || although it should not. Coroutines below therefore build their answers through these
// functions, and co_await stands alone in its statement.
Response refusal(int status, const char* code, std::string detail) {
  Problem problem;
  problem.status = status;
  problem.code = code;
  problem.detail = std::move(detail);
  if (status == 503) problem.retry_after_s = 5;
  return to_response(problem);
}

Response too_large(std::size_t most) {
  if (most == 0) return refusal(413, "payload_too_large", "this operation takes no body");
  return refusal(413, "payload_too_large", "the body is over " + std::to_string(most) + " bytes");
}

/// Stands for "there is nobody to answer"; its status is 0.
Response nobody() {
  Response response;
  response.status = 0;
  return response;
}

Answer fault(const Log& log, const Request& request, const char* what) {
  log.error("handler_failed", {{"request", request.id}, {"path", request.path}, {"reason", what}});
  return to_response({500, "internal", "the server failed; its log has request " + request.id});
}

/// The border at which an exception ends a request and not the daemon.
template <class Result, class Function>
Result guarded(const Log& log, const Request& request, Function function) {
  try {
    return function();
  } catch (const std::exception& error) {
    return Result(std::get<Response>(fault(log, request, error.what())));
  } catch (...) {
    return Result(std::get<Response>(fault(log, request, "unknown exception")));
  }
}

class Session {
 public:
  Session(boost::beast::tcp_stream stream, Shared& shared)
      : connection_(std::move(stream), shared), shared_(shared), settings_(shared.settings) {}

  asio::awaitable<void> run() {
    if (shared_.connections.size() > settings_.max_connections) {
      Exchange exchange = begin_exchange();
      const Response response =
          refusal(503, "too_many_connections", "the server has all the connections it may have");
      co_await send(exchange, response);
      exchange.body_unread = true;
      co_await close(exchange);
      co_return;
    }
    bool again = true;
    while (again && !shared_.stopping) again = co_await serve_one();
  }

 private:
  Exchange begin_exchange() {
    Exchange exchange;
    exchange.keep_alive = false;
    exchange.begun = shared_.parts.clock.steady();
    exchange.request.id = shared_.instance + '-' + std::to_string(shared_.next_request++);
    return exchange;
  }

  asio::awaitable<bool> serve_one() {
    connection_.idle = true;
    if (connection_.inbox.empty()) {
      const auto read = co_await read_more(connection_, kReadPiece, after(settings_.idle_timeout));
      if (read.count == 0) co_return false;
    }
    connection_.idle = false;
    Exchange exchange = begin_exchange();
    std::optional<Response> response = co_await read_head(exchange);
    if (!response && connection_.inbox.empty() && exchange.head.method.empty()) co_return false;
    if (!response) response = find_route(exchange);
    if (response) {
      exchange.body_unread = exchange.head.method.empty() || exchange.head.has_body();
      if (exchange.body_unread) exchange.keep_alive = false;
    } else {
      response = co_await carry_out(exchange);
    }
    if (!response) co_return false;  // an event stream has ended, or the peer has gone
    const bool sent = co_await send(exchange, *response);
    if (sent && exchange.keep_alive) co_return true;
    if (sent) co_await close(exchange);
    co_return false;
  }

  /// Nothing when the head is read, or (with an empty method) when the peer has gone.
  asio::awaitable<std::optional<Response>> read_head(Exchange& exchange) {
    std::string& inbox = connection_.inbox;
    const SteadyTime deadline = after(settings_.head_timeout);
    // Empty lines before a request line are to be ignored (RFC 9112, 2.2).
    while (inbox.starts_with("\r\n")) inbox.erase(0, 2);
    std::size_t length = 0;
    while ((length = head_length(inbox)) == 0 && inbox.size() <= kMaxHeadBytes) {
      const auto read = co_await read_more(connection_, kReadPiece, deadline);
      if (read.count > 0) continue;
      inbox.clear();
      if (!read.late) co_return std::nullopt;
      co_return refusal(408, "request_timeout", "the head did not arrive in time");
    }
    if (length == 0) length = inbox.size();
    auto parsed = parse_head(std::string_view(inbox).substr(0, length));
    inbox.erase(0, length);
    if (const auto* error = std::get_if<HeadError>(&parsed)) {
      co_return refusal(error->status, error->code.c_str(), error->detail);
    }
    exchange.head = std::move(std::get<RequestHead>(parsed));
    exchange.keep_alive = exchange.head.keep_alive;
    co_return std::nullopt;
  }

  [[nodiscard]] SteadyTime after(std::chrono::milliseconds time) const {
    return std::chrono::steady_clock::now() + time;
  }

  /// Of a body that stalls.
  static std::optional<Response> stalled(Exchange& exchange, const ReadOutcome& read) {
    if (!read.late) return std::nullopt;
    return refuse_unread(exchange,
                         refusal(408, "request_timeout", "no byte of the body for too long"));
  }

  std::optional<Response> find_route(Exchange& exchange) {
    const RequestHead& head = exchange.head;
    Request& request = exchange.request;
    const auto* host = head.header("host");
    if (host != nullptr && !host_allowed(settings_.hosts, *host)) {
      return to_response({421, "host_not_allowed", "Host is no name of this server", "Host"});
    }
    if (is_cross_origin_write(head)) {
      return to_response({403, "cross_origin", "a page of another origin may not do this", "Origin"});
    }
    auto target = parse_target(head.target);
    if (!target) {
      return to_response({400, "bad_request", "the request target is no plain absolute path"});
    }
    request.method = head.method;
    request.path = std::move(target->path);
    request.query = std::move(target->query);
    request.headers = head.headers;
    auto found = shared_.parts.router.find(head.method, target->segments);
    if (auto* match = std::get_if<Match>(&found)) {
      exchange.route = match->route;
      request.path_parameters = std::move(match->parameters);
      return std::nullopt;
    }
    return no_route(std::get<NoMatch>(found));
  }

  static Response no_route(const NoMatch& none) {
    if (none.allowed_methods.empty()) return to_response({404, "not_found", "no such path"});
    std::string allowed;
    for (const auto& method : none.allowed_methods) {
      allowed += (allowed.empty() ? "" : ", ") + method;
    }
    auto response = to_response({405, "method_not_allowed", "this path takes " + allowed});
    response.headers.emplace_back("Allow", allowed);
    return response;
  }

  /// Body and handler. Nothing when an event stream was served or the peer has gone.
  asio::awaitable<std::optional<Response>> carry_out(Exchange& exchange) {
    if (exchange.route->upload) co_return co_await carry_out_upload(exchange);
    if (auto refusal = co_await read_body(exchange)) {
      if (refusal->status == 0) co_return std::nullopt;
      co_return refusal;
    }
    Answer answer = co_await off_thread(shared_.handlers, [&exchange, this] {
      return guarded<Answer>(shared_.parts.log, exchange.request,
                             [&] { return exchange.route->handler(exchange.request); });
    });
    if (auto* response = std::get_if<Response>(&answer)) co_return std::move(*response);
    co_await stream(exchange, std::get<std::unique_ptr<EventFeed>>(std::move(answer)));
    co_return std::nullopt;
  }

  asio::awaitable<void> stream(Exchange& exchange, std::unique_ptr<EventFeed> feed) {
    Response response;
    response.content_type = "text/event-stream";
    response.headers = {{"Cache-Control", "no-store"}, {"X-Accel-Buffering", "no"}};
    exchange.keep_alive = false;
    std::string head = response_head(response, framing(exchange, true));
    account(exchange, 200);
    auto& open = shared_.parts.metrics.gauge("raykiln_http_event_streams", "Event streams that are open");
    open.add(1);
    if (exchange.head.method == "HEAD") {
      co_await write_all(connection_, head);
    } else {
      co_await run_event_stream(connection_, std::move(feed), std::move(head));
    }
    open.add(-1);
    co_await close(exchange);
  }

  /// Reads a bounded body whole. Status 0: the peer has gone.
  asio::awaitable<std::optional<Response>> read_body(Exchange& exchange) {
    const std::size_t most = exchange.route->max_body_bytes;
    if (exchange.head.content_length.value_or(0) > most) {
      co_return refuse_unread(exchange, too_large(most));
    }
    const bool wanted = co_await say_continue(exchange);
    if (!wanted) co_return nobody();
    BodyDecoder decoder(exchange.head);
    while (!decoder.done()) {
      const auto step = decoder.feed(connection_.inbox);
      exchange.request.body.append(step.payload);
      connection_.inbox.erase(0, step.consumed);
      if (exchange.request.body.size() > most) co_return refuse_unread(exchange, too_large(most));
      if (decoder.failed()) {
        co_return refuse_unread(exchange, refusal(400, "bad_request", decoder.error()));
      }
      if (decoder.done() || step.consumed > 0) continue;
      const auto read = co_await read_more(connection_, kReadPiece, after(settings_.body_timeout));
      if (read.count == 0) co_return stalled(exchange, read).value_or(nobody());
    }
    co_return std::nullopt;
  }

  asio::awaitable<bool> say_continue(Exchange& exchange) {
    if (!exchange.head.expect_continue || !exchange.head.has_body()) co_return true;
    if (!connection_.inbox.empty()) co_return true;
    const bool sent = co_await write_all(connection_, "HTTP/1.1 100 Continue\r\n\r\n");
    co_return sent;
  }

  asio::awaitable<std::optional<Response>> carry_out_upload(Exchange& exchange) {
    UploadStart start = co_await off_thread(shared_.handlers, [&exchange, this] {
      return guarded<UploadStart>(shared_.parts.log, exchange.request,
                                  [&] { return exchange.route->upload(exchange.request); });
    });
    if (auto* early = std::get_if<Response>(&start)) co_return refuse_unread(exchange, *early);
    auto plan = std::get<UploadPlan>(std::move(start));
    if (exchange.head.content_length.value_or(0) > plan.max_bytes) {
      const std::size_t most = plan.max_bytes;
      // The plan is dropped off this thread: it removes files.
      co_await off_thread(shared_.handlers, [&plan] { plan.upload.reset(); return true; });
      co_return refuse_unread(exchange, too_large(most));
    }
    const bool wanted = co_await say_continue(exchange);
    if (!wanted) co_return std::nullopt;
    auto body = std::make_unique<UploadBody>(exchange.head, std::move(plan));
    auto response = co_await receive(exchange, *body);
    co_await off_thread(shared_.handlers, [&body] { body.reset(); return true; });
    co_return response;
  }

  static Response refuse_unread(Exchange& exchange, Response response) {
    exchange.body_unread = exchange.head.has_body();
    if (exchange.body_unread) exchange.keep_alive = false;
    return response;
  }

  asio::awaitable<std::optional<Response>> receive(Exchange& exchange, UploadBody& body) {
    while (true) {
      auto progress = co_await off_thread(shared_.handlers, [&] { return feed(exchange, body); });
      connection_.inbox.erase(0, progress.consumed);
      if (progress.refusal) co_return refuse_unread(exchange, std::move(*progress.refusal));
      if (progress.done) break;
      const auto read = co_await read_more(connection_, kUploadPiece, after(settings_.body_timeout));
      if (read.count == 0) co_return stalled(exchange, read);
    }
    co_return co_await off_thread(shared_.handlers, [&] {
      return guarded<Response>(shared_.parts.log, exchange.request, [&] { return body.finish(); });
    });
  }

  UploadBody::Progress feed(const Exchange& exchange, UploadBody& body) {
    UploadBody::Progress progress;
    auto failure = guarded<Response>(shared_.parts.log, exchange.request, [&] {
      progress = body.feed(connection_.inbox);
      return nobody();
    });
    if (failure.status != 0) progress.refusal = std::move(failure);
    return progress;
  }

  ResponseFraming framing(const Exchange& exchange, bool until_close) const {
    return {.keep_alive = exchange.keep_alive && !shared_.stopping,
            .http_1_0 = exchange.head.http_1_0,
            .until_close = until_close,
            .request_id = exchange.request.id,
            .now = shared_.parts.clock.wall()};
  }

  asio::awaitable<bool> send(Exchange& exchange, const Response& response) {
    std::string text = response_head(response, framing(exchange, false));
    const bool with_body = response.body && exchange.head.method != "HEAD";
    exchange.sent = with_body ? response.body->size() : 0;
    account(exchange, response.status);
    // One packet for small answers, no copy of large ones.
    const bool small = with_body && response.body->size() <= kReadPiece;
    if (small) text.append(*response.body);
    bool sent = co_await write_all(connection_, text);
    if (sent && with_body && !small) {
      sent = co_await write_all(connection_, *response.body);
    }
    co_return sent;
  }

  void account(const Exchange& exchange, int status) {
    const double seconds = seconds_between(exchange.begun, shared_.parts.clock.steady());
    const std::string route = exchange.route != nullptr ? exchange.route->pattern : "none";
    const std::string method = exchange.route != nullptr ? exchange.route->method : "none";
    auto& metrics = shared_.parts.metrics;
    metrics.counter("raykiln_http_requests_total", "Requests by route and status",
                    {{"method", method}, {"route", route}, {"status", std::to_string(status)}})
        .add();
    metrics.histogram("raykiln_http_request_seconds", "From the first byte to the answer",
                      {0.001, 0.005, 0.02, 0.1, 0.5, 2, 10, 60}, {{"route", route}})
        .observe(seconds);
    const std::initializer_list<LogField> fields = {
        {"request", exchange.request.id}, {"method", exchange.head.method}, {"route", route},
        {"path", exchange.request.path},  {"status", status},               {"bytes", exchange.sent},
        {"seconds", seconds}};
    if (status >= 500) shared_.parts.log.warn("request", fields);
    else if (status >= 400 || method != "GET") shared_.parts.log.info("request", fields);
    else shared_.parts.log.debug("request", fields);
  }

  /// Ends the connection so that the peer can read the answer although it is still sending: closing
  /// with unread bytes would reset it.
  asio::awaitable<void> close(const Exchange& exchange) {
    boost::system::error_code ignored;  // the peer may be gone already
    connection_.stream.socket().shutdown(boost::asio::ip::tcp::socket::shutdown_send, ignored);
    if (!exchange.body_unread) co_return;
    const SteadyTime deadline = after(kLingerTime);
    std::size_t drained = 0;
    while (drained < kLingerBytes && !shared_.stopping) {
      connection_.inbox.clear();
      const auto read = co_await read_more(connection_, kUploadPiece, deadline);
      if (read.count == 0) break;
      drained += read.count;
    }
  }

  Connection connection_;
  Shared& shared_;
  const ServerSettings& settings_;
};

}  // namespace

Connection::Connection(boost::beast::tcp_stream s, Shared& all)
    : shared(all), stream(std::move(s)), alarm(all.io) {
  shared.connections.insert(this);
  shared.parts.metrics.gauge("raykiln_http_connections", "Open connections").add(1);
}

Connection::~Connection() {
  shared.connections.erase(this);
  shared.parts.metrics.gauge("raykiln_http_connections", "Open connections").add(-1);
}

void Connection::wind_down() {
  if (idle) stream.cancel();
  if (events != nullptr) {
    events->stop();
    alarm.cancel();
  }
}

asio::awaitable<void> run_session(boost::beast::tcp_stream stream, Shared& shared) {
  Session session(std::move(stream), shared);
  try {
    co_await session.run();
  } catch (const std::exception& error) {
    shared.parts.log.error("session_failed", {{"reason", error.what()}});
  }
}

}  // namespace raykiln::server
