// multipart/form-data, read as it arrives (RFC 7578, RFC 2046) in bounded memory.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace raykiln::server {

inline constexpr std::size_t kMaxPartHeadBytes = 4096;
inline constexpr int kMaxParts = 256;

/// The boundary out of a Content-Type, or nothing when it is not multipart/form-data with a boundary
/// of 1 to 70 characters.
[[nodiscard]] std::optional<std::string> multipart_boundary(std::string_view content_type);

/// The file name out of a Content-Disposition value, or nothing.
[[nodiscard]] std::optional<std::string> disposition_filename(std::string_view value);

/// Where the parts go. Each returns false to stop the parser.
struct MultipartSink {
  std::function<bool(const std::string& filename)> begin;
  std::function<bool(std::string_view bytes)> bytes;
  std::function<bool()> end;
};

/// A push parser. However the body is cut, the sink sees the same files and bytes (only the cuts
/// inside `bytes` differ). Holds back at most the length of a delimiter, or one part's head.
class MultipartParser {
 public:
  MultipartParser(std::string boundary, MultipartSink sink);

  /// False once the body is malformed or the sink has refused.
  [[nodiscard]] bool feed(std::string_view bytes);

  /// True when the closing delimiter has been seen.
  [[nodiscard]] bool complete() const { return state_ == State::kEpilogue; }
  [[nodiscard]] bool refused_by_sink() const { return refused_; }
  [[nodiscard]] const std::string& error() const { return error_; }

 private:
  enum class State { kStart, kAfterDelimiter, kPartHead, kPartBody, kEpilogue, kFailed };

  [[nodiscard]] bool step();
  [[nodiscard]] bool read_start();
  [[nodiscard]] bool read_after_delimiter();
  [[nodiscard]] bool read_part_head();
  [[nodiscard]] bool read_part_body();
  [[nodiscard]] bool pass_on(std::string_view bytes);
  bool fail(std::string why);

  std::string delimiter_;  ///< CR LF -- boundary
  MultipartSink sink_;
  State state_ = State::kStart;
  std::string pending_;
  std::size_t position_ = 0;  ///< start of what is not consumed in pending_
  int parts_ = 0;
  bool refused_ = false;
  std::string error_;
};

}  // namespace raykiln::server
