#include "raykiln/http/sse_session.hpp"

#include <gtest/gtest.h>

namespace raykiln::server {
namespace {

using std::chrono::milliseconds;
using Do = SseSession::Do;

const SteadyTime kStart{std::chrono::hours(1)};
const SseTiming kTiming{milliseconds(100), milliseconds(15'000)};

SteadyTime at(int ms) { return kStart + milliseconds(ms); }

TEST(SseSession, SendsTheSnapshotAtOnce) {
  SseSession session(kTiming, kStart);
  EXPECT_EQ(session.next(at(0)).what, Do::kPoll);
}

TEST(SseSession, SleepsUntilTheHeartbeat) {
  SseSession session(kTiming, kStart);
  session.polled({"event", false}, at(0));
  session.written(at(0));
  EXPECT_EQ(session.next(at(5)).what, Do::kWait);
  EXPECT_EQ(session.next(at(5)).until, at(15'000));
  EXPECT_EQ(session.next(at(15'000)).what, Do::kHeartbeat);
  session.written(at(15'000));
  EXPECT_EQ(session.next(at(15'000)).until, at(30'000));
}

TEST(SseSession, KeepsTheLeastGapBetweenEvents) {
  SseSession session(kTiming, kStart);
  session.polled({"event", false}, at(0));
  session.written(at(0));
  for (int wake = 0; wake < 1000; ++wake) session.woken();
  EXPECT_EQ(session.next(at(50)).what, Do::kWait);
  EXPECT_EQ(session.next(at(50)).until, at(100));
  EXPECT_EQ(session.next(at(100)).what, Do::kPoll);
  session.polled({"", false}, at(100));  // all wake-ups together came to one poll
  EXPECT_EQ(session.next(at(200)).what, Do::kWait);
}

TEST(SseSession, EndsAfterTheFinalEvent) {
  SseSession session(kTiming, kStart);
  session.polled({"final", true}, at(0));
  session.written(at(0));
  session.woken();
  EXPECT_EQ(session.next(at(200)).what, Do::kEnd);
}

TEST(SseSession, EndsWhenTheServerStops) {
  SseSession session(kTiming, kStart);
  session.stop();
  EXPECT_EQ(session.next(at(0)).what, Do::kEnd);
}

}  // namespace
}  // namespace raykiln::server
