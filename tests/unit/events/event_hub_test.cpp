#include <gtest/gtest.h>

#include "raykiln/events/event_hub.hpp"

namespace raykiln::server {
namespace {

SnapshotPtr at(std::uint64_t revision, JobState state = JobState::kRendering) {
  JobSnapshot snapshot;
  snapshot.id = "j";
  snapshot.revision = revision;
  snapshot.state = state;
  return std::make_shared<const JobSnapshot>(snapshot);
}

TEST(EventHub, ASlowReaderCostsOneWakeAndSeesTheNewest) {
  EventHub hub(4);
  int wakes = 0;
  auto reader = hub.subscribe(at(1), [&] { ++wakes; });
  ASSERT_TRUE(reader);
  EXPECT_EQ((*reader)->take()->revision, 1U);
  for (std::uint64_t r = 2; r <= 100; ++r) hub.publish(at(r));
  EXPECT_EQ(wakes, 1);
  hub.publish(at(50));
  EXPECT_EQ((*reader)->take()->revision, 100U);
  EXPECT_EQ((*reader)->take(), nullptr);
  hub.publish(at(101));
  EXPECT_EQ(wakes, 2);
}

TEST(EventHub, TheFinalStateIsDeliveredLast) {
  EventHub hub(4);
  auto reader = hub.subscribe(at(1), [] {});
  hub.publish(at(2));
  hub.publish(at(3, JobState::kCompleted));
  hub.publish(at(4));
  EXPECT_EQ((*reader)->take()->state, JobState::kCompleted);
  EXPECT_EQ((*reader)->take(), nullptr);
  auto late = hub.subscribe(at(3, JobState::kCompleted), [] {});
  EXPECT_EQ((*late)->take()->revision, 3U);
}

TEST(EventHub, WhatTheServerWatchesTakesNoClientsPlace) {
  EventHub hub(1);
  const auto own = hub.subscribe(at(1), [] {}, Seat::kServer), another = hub.subscribe(at(1), [] {}, Seat::kServer);
  EXPECT_EQ(hub.clients(), 0U);
  EXPECT_TRUE(own && another);
  const auto client = hub.subscribe(at(1), [] {});
  EXPECT_TRUE(client);
  EXPECT_TRUE(hub.subscribe(at(1), [] {}, Seat::kServer));
  EXPECT_EQ(hub.clients(), 1U);
}

TEST(EventHub, SubscribersAreBoundedAndLeave) {
  EventHub hub(1);
  int wakes = 0;
  auto one = hub.subscribe(at(1), [&] { ++wakes; });
  const auto two = hub.subscribe(at(1), [] {});
  ASSERT_FALSE(two);
  EXPECT_EQ(two.error().code, "too_many_streams");
  one->reset();
  EXPECT_EQ(hub.clients(), 0U);
  hub.publish(at(2));
  EXPECT_EQ(wakes, 0);
  EXPECT_TRUE(hub.subscribe(at(2), [] {}));
}

}  // namespace
}  // namespace raykiln::server
