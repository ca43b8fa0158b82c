#include "raykiln/http/origin.hpp"

#include <gtest/gtest.h>

namespace raykiln::server {
namespace {

TEST(Origin, TakesLiteralsAndNamedHosts) {
  const HostPolicy policy{{"render.example"}};
  for (const char* host : {"localhost", "LOCALHOST:8080", "127.0.0.1:1", "10.0.0.7", "[::1]:8080", "[::1]",
                           "render.example:80", "Render.Example"}) {
    EXPECT_TRUE(host_allowed(policy, host)) << host;
  }
  for (const char* host : {"", "evil.example", "localhost.evil.example", "127.0.0.1.evil.example:80",
                           "render.example.evil", "127.0.0.1:80:80", "[evil]", "localhost:8x", "::1"}) {
    EXPECT_FALSE(host_allowed(policy, host)) << host;
  }
  EXPECT_TRUE(host_allowed({{"*"}}, "anything.example"));
}

RequestHead write_from(const char* origin, const char* site) {
  RequestHead head;
  head.method = "POST";
  head.headers = {{"host", "127.0.0.1:8080"}};
  if (origin != nullptr) head.headers.emplace_back("origin", origin);
  if (site != nullptr) head.headers.emplace_back("sec-fetch-site", site);
  return head;
}

TEST(Origin, RefusesWritesFromOtherPages) {
  EXPECT_FALSE(is_cross_origin_write(write_from(nullptr, nullptr)));
  EXPECT_FALSE(is_cross_origin_write(write_from("http://127.0.0.1:8080", "same-origin")));
  EXPECT_TRUE(is_cross_origin_write(write_from("http://evil.example", nullptr)));
  EXPECT_TRUE(is_cross_origin_write(write_from("http://127.0.0.1:3000", nullptr)));
  EXPECT_TRUE(is_cross_origin_write(write_from("null", nullptr)));
  EXPECT_TRUE(is_cross_origin_write(write_from(nullptr, "cross-site")));
  EXPECT_TRUE(is_cross_origin_write(write_from(nullptr, "same-site")));
  auto read = write_from("http://evil.example", "cross-site");
  read.method = "GET";
  EXPECT_FALSE(is_cross_origin_write(read));
}

TEST(Origin, KnowsLoopback) {
  EXPECT_TRUE(is_loopback("127.0.0.1"));
  EXPECT_TRUE(is_loopback("::1"));
  EXPECT_FALSE(is_loopback("0.0.0.0"));
  EXPECT_FALSE(is_loopback("127.evil.example"));
}

}  // namespace
}  // namespace raykiln::server
