#include "raykiln/http/body_decoder.hpp"

#include <algorithm>
#include <utility>

namespace raykiln::server {
namespace {

constexpr int kMaxSizeDigits = 12;

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

}  // namespace

BodyDecoder::BodyDecoder(const RequestHead& head)
    : state_(head.chunked ? State::kSize : State::kPayload),
      left_(head.content_length.value_or(0)) {
  if (state_ == State::kPayload && left_ == 0) state_ = State::kDone;
}

BodyDecoder::Step BodyDecoder::feed(std::string_view input) {
  std::size_t consumed = 0;
  while (consumed < input.size()) {
    if (state_ == State::kDone || state_ == State::kFailed) break;
    if (state_ == State::kPayload || state_ == State::kChunk) {
      Step step = take_payload(input.substr(consumed));
      step.consumed += consumed;
      return step;
    }
    take_framing(input[consumed]);
    ++consumed;
  }
  return {consumed, {}};
}

BodyDecoder::Step BodyDecoder::take_payload(std::string_view input) {
  const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(left_, input.size()));
  left_ -= count;
  if (left_ == 0) state_ = state_ == State::kPayload ? State::kDone : State::kChunkCr;
  return {count, input.substr(0, count)};
}

void BodyDecoder::take_framing(char c) {
  const auto expect = [&](char wanted, State next) {
    if (c == wanted) state_ = next;
    else fail("chunk framing broken");
  };
  switch (state_) {
    case State::kSize: return take_size(c);
    case State::kSizeLf: return expect('\n', left_ == 0 ? State::kEndCr : State::kChunk);
    case State::kChunkCr: return expect('\r', State::kChunkLf);
    case State::kChunkLf:
      size_digits_ = 0;
      return expect('\n', State::kSize);
    case State::kEndCr:
      if (c != '\r') return fail("trailers are not taken");
      state_ = State::kEndLf;
      return;
    case State::kEndLf: return expect('\n', State::kDone);
    case State::kPayload:
    case State::kChunk:
    case State::kDone:
    case State::kFailed: return;
  }
}

void BodyDecoder::take_size(char c) {
  const int digit = hex_digit(c);
  if (digit >= 0) {
    if (++size_digits_ > kMaxSizeDigits) return fail("chunk size too large");
    left_ = left_ * 16 + static_cast<std::uint64_t>(digit);
    return;
  }
  if (size_digits_ == 0) return fail("chunk without a size");
  if (c == ';') return fail("chunk extensions are not taken");
  if (c != '\r') return fail("chunk size is not hexadecimal");
  state_ = State::kSizeLf;
}

void BodyDecoder::fail(std::string why) {
  state_ = State::kFailed;
  error_ = std::move(why);
}

}  // namespace raykiln::server
