#include <array>
#include <boost/asio/as_tuple.hpp>
#include <boost/asio/buffer.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <mutex>

#include "connection.hpp"

namespace raykiln::server {
namespace {

namespace asio = boost::asio;

/// Carries wake-ups from any thread to the I/O thread. Outlives the session if a wake-up is under
/// way when that ends, and then does nothing.
class Waker : public std::enable_shared_from_this<Waker> {
 public:
  Waker(Connection& connection, SseSession& session)
      : connection_(&connection), session_(&session) {}

  void wake() {
    const std::lock_guard lock(mutex_);
    if (connection_ == nullptr) return;
    asio::post(connection_->shared.io, [self = shared_from_this()] { self->deliver(); });
  }

  /// Ends the session when the peer closes its side, which else would be noticed at the next
  /// heartbeat only. What it sends is thrown away: the connection ends with the stream.
  void watch_peer() {
    connection_->stream.socket().async_read_some(
        asio::buffer(ignored_),
        [self = shared_from_this()](const boost::system::error_code& error, std::size_t) {
          if (self->connection_ == nullptr) return;
          if (!error) return self->watch_peer();
          self->session_->stop();
          self->connection_->alarm.cancel();
        });
  }

  void close() {
    const std::lock_guard lock(mutex_);
    connection_ = nullptr;
  }

 private:
  void deliver() {
    // On the I/O thread, as close() is: the pointer cannot change meanwhile.
    if (connection_ == nullptr) return;
    session_->woken();
    connection_->alarm.cancel();
  }

  std::mutex mutex_;
  Connection* connection_;
  SseSession* session_;
  std::array<char, 256> ignored_{};
};

/// Ties the session to its connection and waker for as long as the stream lasts.
class Attachment {
 public:
  Attachment(Connection& connection, SseSession& session)
      : connection_(connection), waker_(std::make_shared<Waker>(connection, session)) {
    connection_.events = &session;
    if (connection_.shared.stopping) session.stop();
  }
  ~Attachment() {
    waker_->close();
    connection_.events = nullptr;
  }
  Attachment(const Attachment&) = delete;
  Attachment& operator=(const Attachment&) = delete;
  [[nodiscard]] const std::shared_ptr<Waker>& waker() const { return waker_; }

 private:
  Connection& connection_;
  std::shared_ptr<Waker> waker_;
};

}  // namespace

asio::awaitable<void> run_event_stream(Connection& connection, std::unique_ptr<EventFeed> feed,
                                       std::string head) {
  const Clock& clock = connection.shared.parts.clock;
  SseSession session(connection.shared.settings.sse, clock.steady());
  const Attachment attachment(connection, session);
  attachment.waker()->watch_peer();
  feed->start([waker = attachment.waker()] { waker->wake(); });
  head.append(kSsePreamble);
  const bool begun = co_await write_all(connection, head);
  if (!begun) co_return;

  while (true) {
    const auto action = session.next(clock.steady());
    if (action.what == SseSession::Do::kEnd) co_return;
    if (action.what == SseSession::Do::kWait) {
      connection.alarm.expires_at(action.until);
      co_await connection.alarm.async_wait(asio::as_tuple(asio::use_awaitable));
      continue;
    }
    std::string text(kSseHeartbeat);
    if (action.what == SseSession::Do::kPoll) {
      FeedStep step = feed->poll();
      session.polled(step, clock.steady());
      text = std::move(step.event);
    }
    if (text.empty()) continue;
    const bool sent = co_await write_all(connection, text);
    if (!sent) co_return;
    session.written(clock.steady());
  }
}

}  // namespace raykiln::server
