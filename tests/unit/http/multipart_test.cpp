#include "raykiln/http/multipart.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace raykiln::server {
namespace {

struct File {
  std::string name, bytes;
  bool ended = false;
  friend bool operator==(const File&, const File&) = default;
};

struct Outcome {
  std::vector<File> files;
  bool accepted = true, complete = false;
  std::string error;
};

Outcome parse(const std::string& body, std::size_t piece) {
  Outcome outcome;
  MultipartSink sink;
  sink.begin = [&](const std::string& name) {
    outcome.files.push_back({name, "", false});
    return true;
  };
  sink.bytes = [&](std::string_view bytes) {
    outcome.files.back().bytes += bytes;
    return true;
  };
  sink.end = [&] { return outcome.files.back().ended = true; };
  MultipartParser parser("B", sink);
  for (std::size_t at = 0; at < body.size() && outcome.accepted; at += piece) {
    outcome.accepted = parser.feed(std::string_view(body).substr(at, piece));
  }
  outcome.complete = parser.complete();
  outcome.error = parser.error();
  return outcome;
}

std::string part(const std::string& name, const std::string& bytes) {
  return "--B\r\nContent-Disposition: form-data; name=\"file\"; filename=\"" + name +
         "\"\r\nContent-Type: text/plain\r\n\r\n" + bytes + "\r\n";
}

TEST(Multipart, GivesTheSameFilesAtEveryCut) {
  const std::string tricky = "a\r\n--\r\n-B\r\n--A\r\n\r\n--b\r";
  const std::string body = part("a.obj", tricky) + part("empty", "") + part("dir/b \\\"q\\\".mtl", "x") + "--B--\r\n";
  const std::vector<File> wanted{{"a.obj", tricky, true}, {"empty", "", true}, {"dir/b \"q\".mtl", "x", true}};
  for (std::size_t piece = 1; piece <= body.size(); ++piece) {
    const auto outcome = parse(body, piece);
    EXPECT_TRUE(outcome.accepted) << outcome.error;
    EXPECT_TRUE(outcome.complete);
    EXPECT_EQ(outcome.files, wanted) << piece;
  }
}

TEST(Multipart, IsNotCompleteWhenTruncated) {
  const std::string body = part("a", "bytes") + "--B--";
  for (std::size_t size = 0; size < body.size(); ++size) {
    const auto outcome = parse(body.substr(0, size), 7);
    EXPECT_TRUE(outcome.accepted) << size;
    EXPECT_FALSE(outcome.complete) << size;
  }
  EXPECT_TRUE(parse(body, 7).complete);
}

TEST(Multipart, RefusesMalformedBodies) {
  for (const std::string& body :
       {std::string("preamble\r\n--B\r\n"), std::string("--C\r\n"), std::string("--Bx\r\n"),
        std::string("--B\r\nContent-Disposition: form-data; name=\"a\"\r\n\r\nx\r\n--B--"),
        std::string("--B\r\nContent-Type: text/plain\r\n\r\nx\r\n--B--"),
        std::string("--B\r\nContent-Disposition: attachment; filename=\"a\"\r\n\r\nx\r\n--B--"),
        std::string("--B\r\nContent-Disposition: form-data; filename=\"a\"; filename=\"b\"\r\n\r\nx\r\n--B--"),
        std::string("--B\r\nno colon\r\n\r\nx\r\n--B--"), "--B\r\nA: " + std::string(5000, 'a')}) {
    const auto outcome = parse(body, 5);
    EXPECT_FALSE(outcome.accepted) << body.substr(0, 80);
    EXPECT_FALSE(outcome.error.empty());
  }
}

TEST(Multipart, BoundsTheNumberOfParts) {
  std::string body;
  for (int i = 0; i < kMaxParts; ++i) body += part(std::to_string(i), "x");
  EXPECT_TRUE(parse(body + "--B--", 4096).complete);
  EXPECT_FALSE(parse(body + part("more", "x") + "--B--", 4096).accepted);
}

TEST(Multipart, StopsWhenTheSinkRefuses) {
  int bytes_calls = 0;
  MultipartParser parser("B", {[](const std::string&) { return true; },
                               [&](std::string_view) { return ++bytes_calls > 1; }, [] { return true; }});
  EXPECT_FALSE(parser.feed(part("a", std::string(100, 'x')) + "--B--"));
  EXPECT_TRUE(parser.refused_by_sink());
  EXPECT_FALSE(parser.feed("more"));
  EXPECT_EQ(bytes_calls, 1);
}

TEST(Multipart, FindsTheBoundary) {
  EXPECT_EQ(multipart_boundary("multipart/form-data; boundary=abc"), "abc");
  EXPECT_EQ(multipart_boundary("Multipart/Form-Data; charset=x; Boundary=\"a b\""), "a b");
  for (const std::string text : {"multipart/mixed; boundary=a", "multipart/form-data", "multipart/form-data; boundary=",
                                 "multipart/form-data; boundary=a; boundary=b", "multipart/form-data; boundary=\"a",
                                 "multipart/form-data; boundary=\"a\x01\""}) {
    EXPECT_EQ(multipart_boundary(text), std::nullopt) << text;
  }
  EXPECT_EQ(multipart_boundary("multipart/form-data; boundary=" + std::string(71, 'a')), std::nullopt);
}

}  // namespace
}  // namespace raykiln::server
