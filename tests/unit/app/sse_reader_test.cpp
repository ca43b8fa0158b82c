#include "raykiln/app/sse_reader.hpp"

#include <gtest/gtest.h>

namespace raykiln::server {
namespace {

TEST(SseReader, GivesTheSameEventsAtEveryCut) {
  const std::string text =
      "retry: 2000\n\n: heartbeat\n\nid: 7\nevent: job\ndata: {\"a\":1}\n\nid:8\r\ndata:x\r\ndata: y\r\n\r\nid: 9\n\ndata: cut";
  for (std::size_t piece = 1; piece <= text.size(); ++piece) {
    SseReader reader;
    std::vector<SseEvent> all;
    for (std::size_t at = 0; at < text.size(); at += piece) {
      const auto events = reader.feed(std::string_view(text).substr(at, piece));
      ASSERT_TRUE(events);
      all.insert(all.end(), events->begin(), events->end());
    }
    ASSERT_EQ(all.size(), 2U) << piece;
    EXPECT_EQ(all[0].id, "7");
    EXPECT_EQ(all[0].event, "job");
    EXPECT_EQ(all[0].data, "{\"a\":1}");
    EXPECT_EQ(all[1].id, "8");
    EXPECT_EQ(all[1].data, "x\ny");
  }
}

TEST(SseReader, HasABound) {
  SseReader reader;
  const std::string piece(1 << 20, 'x');
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(reader.feed(piece));
  EXPECT_FALSE(reader.feed(piece));
}

}  // namespace
}  // namespace raykiln::server
