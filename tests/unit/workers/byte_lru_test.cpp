#include "byte_lru.hpp"

#include <gtest/gtest.h>

namespace raykiln::server {
namespace {

TEST(ByteLru, DropsTheLeastRecentlyUsedBeyondItsBytes) {
  ByteLru<int> lru(100);
  lru.insert("a", 1, 40);
  lru.insert("b", 2, 40);
  EXPECT_EQ(lru.use("a"), 1);
  lru.insert("c", 3, 40);
  EXPECT_FALSE(lru.contains("b"));
  EXPECT_TRUE(lru.contains("a"));
  EXPECT_EQ(lru.bytes(), 80U);
  lru.insert("a", 4, 10);
  EXPECT_EQ(lru.bytes(), 50U);
  lru.insert("huge", 5, 1000);
  EXPECT_EQ(lru.use("huge"), 5) << "what is being used now stays";
  EXPECT_EQ(lru.bytes(), 1000U);
  lru.insert("beside", 6, 20, {"huge", "not there"});
  EXPECT_TRUE(lru.contains("huge")) << "what the last one refers to stays with it";
  EXPECT_EQ(lru.bytes(), 1020U);
  lru.insert("next", 7, 30);
  EXPECT_FALSE(lru.contains("beside") || lru.contains("huge")) << "who refers goes first";
  EXPECT_EQ(lru.bytes(), 30U);
  lru.insert("next to it", 8, 1000, {"next"});
  lru.insert("b", 9, 1000, {"next", "next to it"});
  EXPECT_EQ(lru.bytes(), 2030U) << "all that it refers to";
  EXPECT_EQ(lru.keys_with("next"), (std::vector<std::string>{"next", "next to it"}));
  EXPECT_TRUE(lru.keys_with("nexus").empty());
  lru.erase("b");
  lru.erase("next to it");
  lru.erase("next");
  EXPECT_EQ(lru.bytes(), 0U);
}

}  // namespace
}  // namespace raykiln::server
