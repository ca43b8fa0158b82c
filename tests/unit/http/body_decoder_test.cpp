#include "raykiln/http/body_decoder.hpp"

#include <gtest/gtest.h>

namespace raykiln::server {
namespace {

struct Decoded {
  std::string payload, error;
  std::size_t consumed = 0;
  bool done = false;
};

/// Feeds `text` in pieces of `piece` bytes.
Decoded decode(const RequestHead& head, std::string_view text, std::size_t piece) {
  BodyDecoder decoder(head);
  Decoded result;
  while (!decoder.done() && !decoder.failed() && result.consumed < text.size()) {
    auto input = text.substr(result.consumed, piece);
    while (!input.empty()) {
      const auto step = decoder.feed(input);
      result.payload += step.payload;
      result.consumed += step.consumed;
      input.remove_prefix(step.consumed);
      if (step.consumed == 0) break;
    }
  }
  result.done = decoder.done();
  result.error = decoder.error();
  return result;
}

RequestHead chunked() {
  RequestHead head;
  head.chunked = true;
  return head;
}

TEST(BodyDecoder, CountsALength) {
  RequestHead head;
  head.content_length = 5;
  for (std::size_t piece = 1; piece < 9; ++piece) {
    const auto result = decode(head, "helloGET /", piece);
    EXPECT_TRUE(result.done);
    EXPECT_EQ(result.payload, "hello");
    EXPECT_EQ(result.consumed, 5U);
  }
}

TEST(BodyDecoder, IsDoneAtOnceWithoutABody) { EXPECT_TRUE(BodyDecoder(RequestHead{}).done()); }

TEST(BodyDecoder, JoinsChunksHoweverTheyAreCut) {
  const std::string text = "5\r\nhello\r\n00A\r\n, world...\r\n0\r\n\r\nNEXT";
  for (std::size_t piece = 1; piece <= text.size(); ++piece) {
    const auto result = decode(chunked(), text, piece);
    EXPECT_TRUE(result.done) << piece;
    EXPECT_EQ(result.payload, "hello, world...");
    EXPECT_EQ(text.substr(result.consumed), "NEXT");
  }
}

TEST(BodyDecoder, RefusesLooseChunks) {
  for (const std::string text :
       {"5;a=b\r\nhello\r\n0\r\n\r\n", "5 \r\nhello\r\n0\r\n\r\n", "\r\n", "g\r\n", "-5\r\nhello\r\n",
        "0x5\r\nhello\r\n", "5\nhello\r\n0\r\n\r\n", "5\r\nhello\n0\r\n\r\n", "5\r\nhelloo\r\n",
        "0\r\nX: y\r\n\r\n", "0\r\n\n", "1000000000000\r\n", "5\r\r\nhello\r\n"}) {
    const auto result = decode(chunked(), text, 3);
    EXPECT_FALSE(result.done) << text;
    EXPECT_FALSE(result.error.empty()) << text;
  }
}

}  // namespace
}  // namespace raykiln::server
