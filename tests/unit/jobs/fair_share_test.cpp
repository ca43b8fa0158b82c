#include <gtest/gtest.h>

#include <map>
#include <string>

#include "raykiln/jobs/fair_share.hpp"

namespace raykiln::server {
namespace {

const auto kAll = [](const std::string&) { return true; };

std::map<std::string, double> serve(FairShare& shares, int turns) {
  std::map<std::string, double> seconds;
  for (int i = 0; i < turns; ++i) {
    const auto id = *shares.pick(kAll);
    shares.charge(id, 0.025);
    seconds[id] += 0.025;
  }
  return seconds;
}

TEST(FairShare, FollowsTheWeights) {
  FairShare shares;
  shares.join("a", 10.0);
  shares.join("b", 10.0);
  shares.join("c", 20.0);
  const auto seconds = serve(shares, 4000);
  EXPECT_NEAR(seconds.at("a"), 25.0, 0.1);
  EXPECT_NEAR(seconds.at("b"), 25.0, 0.1);
  EXPECT_NEAR(seconds.at("c"), 50.0, 0.1);
}

TEST(FairShare, WhoJoinsLateOwesAndIsOwedNothing) {
  FairShare shares;
  shares.join("a", 1.0);
  serve(shares, 1000);
  shares.join("b", 1.0);
  const auto seconds = serve(shares, 100);
  EXPECT_NEAR(seconds.at("a"), seconds.at("b"), 0.06);
}

TEST(FairShare, SkipsWhoHasNoWork) {
  FairShare shares;
  shares.join("a", 1.0);
  EXPECT_EQ(shares.pick([](const std::string&) { return false; }), std::nullopt);
  shares.leave("a");
  EXPECT_EQ(shares.pick(kAll), std::nullopt);
}

}  // namespace
}  // namespace raykiln::server
