#include "raykiln/api/encoded_cache.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <thread>
#include <vector>

namespace raykiln::server {
namespace {

TEST(EncodedCache, EncodesOnceForAllWhoAsk) {
  EncodedCache cache(1000, 10, 2);
  std::atomic<int> encodings = 0;
  std::vector<std::jthread> threads;
  for (int i = 0; i < 8; ++i) {
    threads.emplace_back([&] {
      const auto bytes = cache.get("a", [&]() -> Result<std::string> {
        ++encodings;
        return std::string("picture");
      });
      EXPECT_EQ(**bytes, "picture");
    });
  }
  threads.clear();
  EXPECT_EQ(encodings, 1);
}

TEST(EncodedCache, DropsTheLeastRecentlyUsed) {
  EncodedCache cache(100, 10, 1);
  int encodings = 0;
  const auto get = [&](const std::string& key) {
    static_cast<void>(cache.get(key, [&]() -> Result<std::string> {
      ++encodings;
      return std::string(40, 'x');
    }));
  };
  get("a");
  get("b");
  get("a");
  get("c");  // drops b
  EXPECT_LE(cache.bytes(), 100U);
  get("a");
  EXPECT_EQ(encodings, 3);
  get("b");
  EXPECT_EQ(encodings, 4);
}

TEST(EncodedCache, ServesWhatIsTooLargeToKeep) {
  EncodedCache cache(10, 10, 1);
  const auto bytes = cache.get("a", [] { return Result<std::string>(std::string(50, 'x')); });
  EXPECT_EQ((*bytes)->size(), 50U);
  EXPECT_EQ(cache.bytes(), 0U);
}

TEST(EncodedCache, ForgetsFailures) {
  EncodedCache cache(100, 10, 1);
  EXPECT_FALSE(cache.get("a", []() -> Result<std::string> { throw std::runtime_error("no memory"); }));
  EXPECT_TRUE(cache.get("a", [] { return Result<std::string>(std::string("x")); }));
}

}  // namespace
}  // namespace raykiln::server
