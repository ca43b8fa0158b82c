// The listener: accepts connections and serves a route table until it is stopped.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "raykiln/base/clock.hpp"
#include "raykiln/base/log.hpp"
#include "raykiln/base/metrics.hpp"
#include "raykiln/base/result.hpp"
#include "raykiln/http/origin.hpp"
#include "raykiln/http/router.hpp"
#include "raykiln/http/sse_session.hpp"

namespace raykiln::server {

struct ServerSettings {
  std::string address = "127.0.0.1";
  std::uint16_t port = 8080;  ///< 0: any free one
  int handler_threads = 8;
  std::size_t max_connections = 512;
  std::chrono::milliseconds head_timeout{10'000};  ///< from the first byte to the end of the head
  std::chrono::milliseconds idle_timeout{60'000};  ///< between requests
  std::chrono::milliseconds body_timeout{30'000};  ///< without any byte
  std::chrono::milliseconds write_timeout{30'000}; ///< without any byte
  SseTiming sse;
  HostPolicy hosts;
};

/// One thread (that of run()) does all I/O, a bounded pool runs the handlers. Memory a connection:
/// 16 KiB of head, one JSON body, 128 KiB of an upload, or one event.
class Server {
 public:
  struct Parts {
    const Router& router;
    const Clock& clock;
    MetricsRegistry& metrics;
    Log log;
  };
  Server(ServerSettings settings, Parts parts);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  /// Binds; gives the port. "address_unavailable" when that cannot be done.
  [[nodiscard]] Result<std::uint16_t> listen();

  /// Serves; returns after stop() when the last session has ended.
  void run();

  /// From any thread: accepts nothing more, ends event streams and idle connections at once, lets
  /// requests in progress finish, and after `grace` closes what is left.
  void stop(std::chrono::milliseconds grace);

 private:
  class Core;
  std::unique_ptr<Core> core_;
};

}  // namespace raykiln::server
