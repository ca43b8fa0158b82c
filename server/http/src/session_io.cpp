#include <algorithm>
#include <boost/asio/as_tuple.hpp>
#include <boost/asio/buffer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/asio/write.hpp>
#include <memory>

#include "connection.hpp"

namespace raykiln::server {

namespace asio = boost::asio;

constexpr std::size_t kWritePiece = 256 * 1024;

asio::awaitable<bool> write_all(Connection& connection, std::string_view bytes) {
  while (!bytes.empty()) {
    const auto piece = bytes.substr(0, kWritePiece);
    connection.stream.expires_after(connection.shared.settings.write_timeout);
    auto [error, count] =
        co_await asio::async_write(connection.stream, asio::buffer(piece.data(), piece.size()),
                                   asio::as_tuple(asio::use_awaitable));
    if (error) co_return false;
    bytes.remove_prefix(count);
  }
  co_return true;
}

asio::awaitable<ReadOutcome> read_more(Connection& connection, std::size_t most,
                                      SteadyTime until) {
  // Not tcp_stream's own timeout, which closes the socket: a late peer is still told so.
  enum class Fate { kReading, kLate, kDone };
  const auto fate = std::make_shared<Fate>(Fate::kReading);
  connection.stream.expires_never();
  connection.alarm.expires_at(until);
  connection.alarm.async_wait([fate, &connection](const boost::system::error_code& error) {
    if (error || *fate != Fate::kReading) return;
    *fate = Fate::kLate;
    connection.stream.cancel();
  });
  const std::size_t old = connection.inbox.size();
  connection.inbox.resize(old + most);
  auto [error, count] = co_await connection.stream.async_read_some(
      asio::buffer(connection.inbox.data() + old, most), asio::as_tuple(asio::use_awaitable));
  connection.inbox.resize(old + (error ? 0 : count));
  const bool late = error && *fate == Fate::kLate;
  *fate = Fate::kDone;
  connection.alarm.cancel();
  co_return ReadOutcome{error ? 0 : count, late};
}

}  // namespace raykiln::server
