// A request and a reply as plain values: what an endpoint sees of HTTP, and nothing of sockets.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace raykiln::server {

using NamedValue = std::pair<std::string, std::string>;

/// First value of `name`, exactly as spelled, or null.
[[nodiscard]] const std::string* find_value(const std::vector<NamedValue>& list,
                                            std::string_view name);

/// Path parameters and query are percent-decoded, header names are lower case, the body is whole
/// and within the route's bound (empty for uploads, which are streamed).
struct Request {
  std::string method;
  std::string path;
  std::vector<NamedValue> path_parameters;
  std::vector<NamedValue> query;
  std::vector<NamedValue> headers;
  std::string body;
  std::string id;  ///< for logs and X-Request-Id
};

using SharedBytes = std::shared_ptr<const std::string>;

/// A whole answer. Date, Connection, Content-Length and X-Request-Id are added by the session.
struct Response {
  int status = 200;
  std::string content_type;  ///< empty: no body
  std::vector<NamedValue> headers;
  SharedBytes body;
};

/// One step of a stream of events.
struct FeedStep {
  std::string event;     ///< whole event, ready to send; empty: nothing new
  bool finished = false; ///< nothing will come after this one
};

/// Newest-wins source of one event stream. `poll` is called by one session at a time; `wake` may be
/// called from any thread, never while the feed's owner holds a lock that poll takes. After the
/// destructor has returned, `wake` is not called any more.
class EventFeed {
 public:
  virtual ~EventFeed() = default;
  virtual void start(std::function<void()> wake) = 0;
  [[nodiscard]] virtual FeedStep poll() = 0;
};

/// What an endpoint answers: a whole reply, or a stream of server-sent events.
using Answer = std::variant<Response, std::unique_ptr<EventFeed>>;

/// One upload while its bytes arrive. Calls may block on the disk; they come one at a time. A reply
/// from any of them but `finish` refuses the upload: no further call but the destructor follows, and
/// the destructor leaves nothing behind.
class Upload {
 public:
  virtual ~Upload() = default;
  /// Multipart only: the following bytes are those of the file with this path.
  [[nodiscard]] virtual std::optional<Response> begin_file(const std::string& name) = 0;
  [[nodiscard]] virtual std::optional<Response> write(std::span<const char> bytes) = 0;
  [[nodiscard]] virtual std::optional<Response> end_file() = 0;
  [[nodiscard]] virtual Response finish() = 0;
};

/// How an upload's body is cut into files.
struct UploadPlan {
  std::unique_ptr<Upload> upload;
  bool multipart = false;       ///< multipart/form-data: every part is a file; else the body is one
  std::uint64_t max_bytes = 0;  ///< of the body
};

/// The head alone decides: an early answer, or where the bytes go.
using UploadStart = std::variant<Response, UploadPlan>;

}  // namespace raykiln::server
