#include "raykiln/http/response_text.hpp"

#include <gtest/gtest.h>

namespace raykiln::server {
namespace {

ResponseFraming framing() {
  return {.request_id = "r-1", .now = std::chrono::system_clock::from_time_t(784111777)};
}

bool has_line(const std::string& head, const std::string& line) {
  return head.find("\r\n" + line + "\r\n") != std::string::npos;
}

TEST(ResponseText, WritesTheHead) {
  Response response;
  response.content_type = "text/html; charset=utf-8";
  response.body = std::make_shared<const std::string>("hello");
  const auto head = response_head(response, framing());
  EXPECT_TRUE(head.starts_with("HTTP/1.1 200 OK\r\n"));
  EXPECT_TRUE(head.ends_with("\r\n\r\n"));
  EXPECT_TRUE(has_line(head, "Date: Sun, 06 Nov 1994 08:49:37 GMT"));  // the example of RFC 9110
  EXPECT_TRUE(has_line(head, "Content-Length: 5"));
  EXPECT_TRUE(has_line(head, "X-Request-Id: r-1"));
  EXPECT_NE(head.find("Content-Security-Policy: default-src 'none'"), std::string::npos);
  EXPECT_EQ(head.find("Connection:"), std::string::npos);
}

TEST(ResponseText, LeavesLengthOutWhereThereIsNone) {
  Response response;
  response.status = 304;
  EXPECT_EQ(response_head(response, framing()).find("Content-Length"), std::string::npos);
  auto stream = framing();
  stream.until_close = true;
  stream.keep_alive = false;
  response.status = 200;
  const auto head = response_head(response, stream);
  EXPECT_EQ(head.find("Content-Length"), std::string::npos);
  EXPECT_TRUE(has_line(head, "Connection: close"));
}

TEST(ResponseText, CannotBeMadeToForgeHeaders) {
  Response response;
  response.headers = {{"Location", "/a\r\nSet-Cookie: x=y"}};
  EXPECT_TRUE(has_line(response_head(response, framing()), "Location: /aSet-Cookie: x=y"));
}

}  // namespace
}  // namespace raykiln::server
