#include "raykiln/http/target.hpp"

#include <gtest/gtest.h>

namespace raykiln::server {
namespace {

TEST(Target, TakesPathsAndQueriesApart) {
  const auto target = parse_target("/v1/jobs/a%2Db?x=1&name=my+sc%C3%A8ne%2B&flag");
  ASSERT_TRUE(target);
  EXPECT_EQ(target->path, "/v1/jobs/a-b");
  EXPECT_EQ(target->segments, (std::vector<std::string>{"v1", "jobs", "a-b"}));
  ASSERT_EQ(target->query.size(), 3U);
  EXPECT_EQ(target->query[1].second, "my sc\xC3\xA8ne+");
  EXPECT_EQ(target->query[2].first, "flag");
  EXPECT_EQ(parse_target("/")->segments, (std::vector<std::string>{""}));
  EXPECT_EQ(parse_target("/a/")->segments, (std::vector<std::string>{"a", ""}));
}

TEST(Target, RefusesWhatIsNoPlainPath) {
  for (const std::string text :
       {"", "*", "a", "http://localhost/", "/../etc/passwd", "/a/./b", "/a/%2e%2e/b", "/a%2fb", "/a%5Cb",
        "/a%00", "/a%0a", "/%", "/%2", "/%zz", "/a?x=%", "/a?x=%0d%0aSet-Cookie", "/a#b", "/a b", "/\\a", "/a\"b"}) {
    EXPECT_FALSE(parse_target(text)) << text;
  }
}

TEST(Target, BoundsSegmentsAndParameters) {
  std::string deep, wide = "/?";
  for (int i = 0; i < 17; ++i) deep += "/a";
  for (int i = 0; i < 33; ++i) wide += "a=b&";
  EXPECT_FALSE(parse_target(deep));
  EXPECT_FALSE(parse_target(wide));
}

}  // namespace
}  // namespace raykiln::server
