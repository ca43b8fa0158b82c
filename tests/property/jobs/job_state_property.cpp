// Whatever happens in whatever order, a job moves along the diagram and ends once.
#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>

#include "raykiln/jobs/job_state.hpp"

namespace raykiln::server {
namespace {

/// The diagram of server/jobs/README.md, written down a second time.
const std::map<JobState, std::set<JobState>>& diagram() {
  using enum JobState;
  static const std::map<JobState, std::set<JobState>> arrows = {
      {kQueued, {kQueued, kPreparing, kCancelled, kFailed}},
      {kPreparing, {kQueued, kRendering, kCancelled, kFailed}},
      {kRendering, {kQueued, kCompleted, kFailed, kCancelling}},
      {kCancelling, {kCancelled}},
      {kCompleted, {}},
      {kFailed, {}},
      {kCancelled, {}}};
  return arrows;
}

TEST(JobStateProperty, RandomEventsStayOnTheDiagram) {
  std::mt19937 random(20260101);
  std::uniform_int_distribution<std::size_t> pick(0, std::size(kAllJobEvents) - 1);
  int ended = 0;
  for (int run = 0; run < 20'000; ++run) {
    JobState state = JobState::kQueued;
    int finals = 0;
    for (int step = 0; step < 40; ++step) {
      const auto next = next_state(state, kAllJobEvents[pick(random)]);
      if (!next) continue;
      ASSERT_FALSE(is_final(state)) << "left " << name(state);
      ASSERT_TRUE(diagram().at(state).contains(*next)) << name(state) << " to " << name(*next);
      state = *next;
      finals += is_final(state) ? 1 : 0;
    }
    ASSERT_LE(finals, 1);
    ended += finals;
  }
  EXPECT_GT(ended, 10'000);
}

TEST(JobStateProperty, EveryUnfinishedStateCanEnd) {
  for (const JobState state : kAllJobStates) {
    bool leads_on = false;
    for (const JobEvent event : kAllJobEvents) leads_on |= next_state(state, event).has_value();
    EXPECT_EQ(leads_on, !is_final(state)) << name(state);
    EXPECT_EQ(job_state_named(name(state)), state);
  }
}

}  // namespace
}  // namespace raykiln::server
