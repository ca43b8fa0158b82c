// The way of an upload's bytes: framing off, multipart apart, into the Upload. No sockets here.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>

#include "raykiln/api/message.hpp"
#include "raykiln/http/body_decoder.hpp"
#include "raykiln/http/head.hpp"
#include "raykiln/http/multipart.hpp"

namespace raykiln::server {

/// Calls block on the disk. Holds no more of the body than the multipart parser does.
class UploadBody {
 public:
  UploadBody(const RequestHead& head, UploadPlan plan);

  struct Progress {
    std::size_t consumed = 0;         ///< of the bytes; what is left belongs to the next request
    bool done = false;                ///< the body is whole: call finish()
    std::optional<Response> refusal;  ///< final answer; nothing more is read
  };
  [[nodiscard]] Progress feed(std::string_view bytes);

  [[nodiscard]] Response finish();

 private:
  [[nodiscard]] std::optional<Response> take(std::string_view payload);
  [[nodiscard]] Response multipart_refusal() const;

  BodyDecoder decoder_;
  UploadPlan plan_;
  std::uint64_t received_ = 0;
  std::unique_ptr<MultipartParser> parser_;
  std::optional<Response> sink_refusal_;
  std::string early_error_;  ///< of the boundary
};

}  // namespace raykiln::server
