// The head of an HTTP/1 request, read strictly: what two readers could take differently is refused.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace raykiln::server {

inline constexpr std::size_t kMaxHeadBytes = 16 * 1024;
inline constexpr std::size_t kMaxTargetBytes = 4096;
inline constexpr std::size_t kMaxHeaderFields = 100;

/// A request that cannot be taken as HTTP. The connection is closed after the answer.
struct HeadError {
  int status;        ///< 400, 414, 417, 431 or 505
  std::string code;  ///< one of the contract's error codes
  std::string detail;
};

struct RequestHead {
  std::string method;
  std::string target;  ///< as sent
  bool http_1_0 = false;
  std::vector<std::pair<std::string, std::string>> headers;  ///< names in lower case, values trimmed
  bool chunked = false;
  std::optional<std::uint64_t> content_length;
  bool keep_alive = true;
  bool expect_continue = false;

  [[nodiscard]] const std::string* header(std::string_view lower_case_name) const;
  [[nodiscard]] bool has_body() const { return chunked || content_length.value_or(0) > 0; }
};

/// Length of the head at the start of `bytes` with its empty line, or 0 when it has not ended yet.
[[nodiscard]] std::size_t head_length(std::string_view bytes);

/// `bytes` is a whole head, the empty line included. Refuses (RFC 9112): bare LF or CR, folded
/// lines, space before a colon, bytes that no header may hold, more than one Host, Content-Length
/// or Transfer-Encoding, both of the last two, any coding but `chunked`, chunked in HTTP/1.0, the
/// Trailer and Upgrade-by-CONNECT mechanisms, any Expect but 100-continue.
[[nodiscard]] std::variant<RequestHead, HeadError> parse_head(std::string_view bytes);

}  // namespace raykiln::server
