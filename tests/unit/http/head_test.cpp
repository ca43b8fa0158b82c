#include "raykiln/http/head.hpp"

#include <gtest/gtest.h>

namespace raykiln::server {
namespace {

/// Status of the refusal; 0: accepted.
int status_of(std::string_view text) {
  const auto parsed = parse_head(text);
  const auto* error = std::get_if<HeadError>(&parsed);
  return error == nullptr ? 0 : error->status;
}

RequestHead accepted(std::string_view text) {
  auto parsed = parse_head(text);
  EXPECT_TRUE(std::holds_alternative<RequestHead>(parsed)) << text;
  return std::holds_alternative<RequestHead>(parsed) ? std::get<RequestHead>(parsed) : RequestHead{};
}

std::string with(const std::string& lines) {
  return "POST /v1/jobs HTTP/1.1\r\nHost: localhost\r\n" + lines + "\r\n";
}

TEST(Head, ReadsWhatClientsSend) {
  const auto head = accepted("GET /a?b=c HTTP/1.1\r\nHost: localhost:80\r\nAccept: \t*/* \r\n\r\n");
  EXPECT_EQ(head.method, "GET");
  EXPECT_EQ(head.target, "/a?b=c");
  EXPECT_EQ(*head.header("accept"), "*/*");
  EXPECT_TRUE(head.keep_alive);
  EXPECT_FALSE(head.has_body());
}

TEST(Head, ReadsFraming) {
  EXPECT_EQ(accepted(with("Content-Length: 12\r\n")).content_length, 12U);
  EXPECT_TRUE(accepted(with("Transfer-Encoding: chunked\r\n")).chunked);
  EXPECT_TRUE(accepted(with("Expect: 100-Continue\r\nContent-Length: 1\r\n")).expect_continue);
  EXPECT_FALSE(accepted(with("Connection: foo, Close\r\n")).keep_alive);
  EXPECT_FALSE(accepted("GET / HTTP/1.0\r\n\r\n").keep_alive);
  EXPECT_TRUE(accepted("GET / HTTP/1.0\r\nConnection: keep-alive\r\n\r\n").keep_alive);
}

TEST(Head, RefusesWhatTwoReadersCouldTakeDifferently) {
  const std::pair<std::string, int> rows[] = {
      {with("Content-Length: 3\r\nTransfer-Encoding: chunked\r\n"), 400},
      {with("Transfer-Encoding: gzip, chunked\r\n"), 400},
      {with("Transfer-Encoding: Chunked\r\n"), 400},
      {with("Transfer-Encoding: chunked\r\nTransfer-Encoding: chunked\r\n"), 400},
      {with("Transfer-Encoding: \r\n"), 400},
      {with("Content-Length: 3\r\nContent-Length: 3\r\n"), 400},
      {with("Content-Length: 3, 3\r\n"), 400},
      {with("Content-Length: +3\r\n"), 400},
      {with("Content-Length: -3\r\n"), 400},
      {with("Content-Length: 0x3\r\n"), 400},
      {with("Content-Length: \r\n"), 400},
      {with("Content-Length: 99999999999999999999\r\n"), 400},
      {with("Content-Length : 3\r\n"), 400},
      {with("Host: other\r\n"), 400},
      {with("A: b\r\n c\r\n"), 400},
      {with("A: b\nC: d\r\n"), 400},
      {with("A: b\rC: d\r\n"), 400},
      {with(std::string("A: b\0c\r\n", 8)), 400},
      {with(": b\r\n"), 400},
      {with("no colon\r\n"), 400},
      {with("Trailer: X\r\n"), 400},
      {with("Expect: something\r\n"), 417},
      {"GET / HTTP/1.1\r\n\r\n", 400},
      {"GET / HTTP/1.1\nHost: a\n\n", 400},
      {"GET  / HTTP/1.1\r\nHost: a\r\n\r\n", 400},
      {"GET / x HTTP/1.1\r\nHost: a\r\n\r\n", 400},
      {"GET /\x01 HTTP/1.1\r\nHost: a\r\n\r\n", 400},
      {"GET /\xC3\xA9 HTTP/1.1\r\nHost: a\r\n\r\n", 400},
      {"GET /\r\nHost: a\r\n\r\n", 400},
      {"G(T / HTTP/1.1\r\nHost: a\r\n\r\n", 400},
      {"GET / HTTP/2.0\r\nHost: a\r\n\r\n", 505},
      {"GET / HTTP/1.2\r\nHost: a\r\n\r\n", 505},
      {"GET / http/1.1\r\nHost: a\r\n\r\n", 400},
      {"POST / HTTP/1.0\r\nTransfer-Encoding: chunked\r\n\r\n", 400},
      {"\r\n\r\n", 400},
      {"GET /" + std::string(5000, 'a') + " HTTP/1.1\r\nHost: a\r\n\r\n", 414},
      {with("A: " + std::string(17000, 'a') + "\r\n"), 431},
  };
  for (const auto& [text, status] : rows) EXPECT_EQ(status_of(text), status) << text.substr(0, 100);
}

TEST(Head, BoundsTheNumberOfFields) {
  std::string lines;
  for (int i = 0; i < 99; ++i) lines.append("a").append(std::to_string(i)).append(": b\r\n");
  EXPECT_EQ(status_of(with(lines)), 0);
  EXPECT_EQ(status_of(with(lines + "z: z\r\n")), 431);
}

TEST(Head, FindsItsEndAtEveryCut) {
  const std::string text = "GET / HTTP/1.1\r\nHost: a\r\n\r\n";
  for (std::size_t cut = 0; cut < text.size(); ++cut) EXPECT_EQ(head_length(text.substr(0, cut)), 0U);
  EXPECT_EQ(head_length(text + "rest"), text.size());
  EXPECT_EQ(head_length("GET / HTTP/1.1\n\nrest"), 16U);
}

}  // namespace
}  // namespace raykiln::server
