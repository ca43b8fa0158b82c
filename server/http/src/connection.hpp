// What sessions share, and one connection's state. All of it belongs to the I/O thread.
#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/thread_pool.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <cstdint>
#include <set>
#include <string>

#include "raykiln/http/server.hpp"

namespace raykiln::server {

struct Connection;

struct Shared {
  Shared(ServerSettings s, Server::Parts p);

  ServerSettings settings;
  Server::Parts parts;
  boost::asio::io_context io{1};
  boost::asio::thread_pool handlers;
  std::set<Connection*> connections;
  std::uint64_t next_request = 1;
  std::string instance;  ///< first part of request ids: differs from start to start
  bool stopping = false;
};

struct Connection {
  Connection(boost::beast::tcp_stream s, Shared& shared);
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  /// The server is stopping: between requests this ends the session, in a stream too.
  void wind_down();

  Shared& shared;
  boost::beast::tcp_stream stream;
  boost::asio::steady_timer alarm;  ///< what an event stream sleeps on
  std::string inbox;                ///< bytes that have arrived and are not consumed
  SseSession* events = nullptr;     ///< while streaming
  bool idle = true;                 ///< between requests
};

/// Serves one connection until it ends. Never throws.
[[nodiscard]] boost::asio::awaitable<void> run_session(boost::beast::tcp_stream stream,
                                                       Shared& shared);

/// Writes an event stream, head included, until it ends or the reader is gone.
[[nodiscard]] boost::asio::awaitable<void> run_event_stream(Connection& connection,
                                                            std::unique_ptr<EventFeed> feed,
                                                            std::string head);

/// Writes all of it, in pieces that each have the write timeout; false when the peer is gone or slow.
[[nodiscard]] boost::asio::awaitable<bool> write_all(Connection& connection, std::string_view bytes);

struct ReadOutcome {
  std::size_t count = 0;  ///< 0: the peer has gone, or `late`
  bool late = false;      ///< the time was over first; the connection can still be written to
};

/// Reads some bytes into the inbox, which grows by at most `most`.
[[nodiscard]] boost::asio::awaitable<ReadOutcome> read_more(Connection& connection, std::size_t most,
                                                            SteadyTime until);

}  // namespace raykiln::server
