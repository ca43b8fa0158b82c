// Takes the framing off a request body: a counted one, or strictly read chunks.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "raykiln/http/head.hpp"

namespace raykiln::server {

/// Fed with raw bytes, gives payload back as views into them; keeps no payload itself. Chunk
/// extensions and trailers are errors: nothing here needs them, and they are where readers differ.
class BodyDecoder {
 public:
  explicit BodyDecoder(const RequestHead& head);

  struct Step {
    std::size_t consumed = 0;   ///< bytes of the input that are done with
    std::string_view payload;   ///< part of the consumed input
  };

  /// One step forward; call again with what is left while it consumes anything.
  [[nodiscard]] Step feed(std::string_view input);

  [[nodiscard]] bool done() const { return state_ == State::kDone; }
  [[nodiscard]] bool failed() const { return state_ == State::kFailed; }
  [[nodiscard]] const std::string& error() const { return error_; }

 private:
  enum class State { kPayload, kSize, kSizeLf, kChunk, kChunkCr, kChunkLf, kEndCr, kEndLf, kDone, kFailed };

  Step take_payload(std::string_view input);
  void take_framing(char c);
  void take_size(char c);
  void fail(std::string why);

  State state_;
  std::uint64_t left_ = 0;  ///< of the body or of the chunk
  int size_digits_ = 0;
  std::string error_;
};

}  // namespace raykiln::server
