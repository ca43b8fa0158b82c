#include "raykiln/http/upload_body.hpp"

#include <utility>

#include "raykiln/api/problem.hpp"

namespace raykiln::server {

UploadBody::UploadBody(const RequestHead& head, UploadPlan plan)
    : decoder_(head), plan_(std::move(plan)) {
  if (!plan_.multipart) return;
  const auto keep = [this](std::optional<Response> refusal) {
    sink_refusal_ = std::move(refusal);
    return !sink_refusal_.has_value();
  };
  MultipartSink sink;
  sink.begin = [this, keep](const std::string& name) { return keep(plan_.upload->begin_file(name)); };
  sink.bytes = [this, keep](std::string_view bytes) {
    return keep(plan_.upload->write({bytes.data(), bytes.size()}));
  };
  sink.end = [this, keep] { return keep(plan_.upload->end_file()); };
  const auto* type = head.header("content-type");
  const auto boundary = multipart_boundary(type == nullptr ? std::string_view{} : *type);
  if (!boundary) early_error_ = "Content-Type without a usable boundary";
  parser_ = std::make_unique<MultipartParser>(boundary.value_or(""), std::move(sink));
}

UploadBody::Progress UploadBody::feed(std::string_view bytes) {
  Progress progress;
  while (!decoder_.done()) {
    const auto step = decoder_.feed(bytes.substr(progress.consumed));
    progress.consumed += step.consumed;
    if (!step.payload.empty()) progress.refusal = take(step.payload);
    if (progress.refusal) return progress;
    if (decoder_.failed()) {
      progress.refusal = to_response({400, "bad_request", decoder_.error()});
      return progress;
    }
    if (step.consumed == 0) return progress;
  }
  progress.done = true;
  return progress;
}

std::optional<Response> UploadBody::take(std::string_view payload) {
  if (!early_error_.empty()) return to_response({400, "invalid_multipart", early_error_});
  received_ += payload.size();
  if (received_ > plan_.max_bytes) {
    return to_response({413, "payload_too_large",
                        "the upload is over " + std::to_string(plan_.max_bytes) + " bytes"});
  }
  if (!parser_) return plan_.upload->write({payload.data(), payload.size()});
  if (parser_->feed(payload)) return std::nullopt;
  return multipart_refusal();
}

Response UploadBody::multipart_refusal() const {
  if (parser_->refused_by_sink() && sink_refusal_) return *sink_refusal_;
  return to_response({400, "invalid_multipart", parser_->error()});
}

Response UploadBody::finish() {
  if (parser_ && !parser_->complete()) {
    return to_response({400, "invalid_multipart", "the body ends before its closing boundary"});
  }
  return plan_.upload->finish();
}

}  // namespace raykiln::server
