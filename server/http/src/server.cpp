#include "raykiln/http/server.hpp"

#include <boost/asio/as_tuple.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <optional>

#include "connection.hpp"
#include "raykiln/base/ids.hpp"

namespace raykiln::server {
namespace asio = boost::asio;
using asio::ip::tcp;

Shared::Shared(ServerSettings s, Server::Parts p)
    : settings(std::move(s)),
      parts(std::move(p)),
      handlers(static_cast<std::size_t>(settings.handler_threads)),
      instance(random_id("").substr(0, 6)) {}

class Server::Core {
 public:
  Core(ServerSettings settings, Parts parts)
      : shared_(std::move(settings), std::move(parts)), acceptor_(shared_.io), deadline_(shared_.io) {}

  Result<std::uint16_t> listen() {
    boost::system::error_code error;
    const auto address = asio::ip::make_address(shared_.settings.address, error);
    if (error) return unavailable(error);
    const tcp::endpoint endpoint(address, shared_.settings.port);
    acceptor_.open(endpoint.protocol(), error);
    if (!error) acceptor_.set_option(asio::socket_base::reuse_address(true), error);
    if (!error) acceptor_.bind(endpoint, error);
    if (!error) acceptor_.listen(asio::socket_base::max_listen_connections, error);
    if (error) return unavailable(error);
    return acceptor_.local_endpoint().port();
  }

  void run() {
    // Sessions are owned by the I/O context and counted in Shared; run() returns when none is left.
    asio::co_spawn(shared_.io, accept_loop(), asio::detached);
    shared_.io.run();
    shared_.handlers.join();
  }

  void stop(std::chrono::milliseconds grace) {
    asio::post(shared_.io, [this, grace] { wind_down(grace); });
  }

 private:
  Error unavailable(const boost::system::error_code& error) const {
    return {ErrorKind::kUnavailable, "address_unavailable", error.message(),
            shared_.settings.address + ':' + std::to_string(shared_.settings.port)};
  }

  asio::awaitable<void> accept_loop() {
    while (!shared_.stopping) {
      auto [error, socket] = co_await acceptor_.async_accept(asio::as_tuple(asio::use_awaitable));
      if (shared_.stopping) break;
      if (error) {
        // Out of descriptors, most often: wait for some to be closed rather than spin.
        shared_.parts.log.warn("accept_failed", {{"reason", error.message()}});
        deadline_.expires_after(std::chrono::milliseconds(100));
        co_await deadline_.async_wait(asio::as_tuple(asio::use_awaitable));
        continue;
      }
      boost::system::error_code ignored;  // a missing option costs speed only
      socket.set_option(tcp::no_delay(true), ignored);
      asio::co_spawn(shared_.io, run_session(boost::beast::tcp_stream(std::move(socket)), shared_),
                     asio::detached);
    }
  }

  void wind_down(std::chrono::milliseconds grace) {
    if (shared_.stopping) return;
    shared_.stopping = true;
    boost::system::error_code ignored;  // closing is all that can be done
    acceptor_.close(ignored);
    for (Connection* connection : shared_.connections) connection->wind_down();
    deadline_.expires_after(grace);
    wait_for_sessions();
  }

  void wait_for_sessions() {
    poll_.emplace(shared_.io, std::chrono::milliseconds(20));
    poll_->async_wait([this](const boost::system::error_code&) {
      if (shared_.connections.empty()) return;
      if (std::chrono::steady_clock::now() >= deadline_.expiry()) {
        for (Connection* connection : shared_.connections) connection->stream.close();
      }
      wait_for_sessions();
    });
  }

  Shared shared_;
  tcp::acceptor acceptor_;
  asio::steady_timer deadline_;
  std::optional<asio::steady_timer> poll_;
};

Server::Server(ServerSettings settings, Parts parts)
    : core_(std::make_unique<Core>(std::move(settings), std::move(parts))) {}
Server::~Server() = default;

Result<std::uint16_t> Server::listen() { return core_->listen(); }
void Server::run() { core_->run(); }
void Server::stop(std::chrono::milliseconds grace) { core_->stop(grace); }

}  // namespace raykiln::server
