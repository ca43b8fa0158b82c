#include "raykiln/jobs/job_state.hpp"

namespace raykiln::server {
namespace {

std::optional<JobState> from_queued(JobEvent event) {
  switch (event) {
    case JobEvent::kStart: return JobState::kPreparing;
    case JobEvent::kCancel: return JobState::kCancelled;
    case JobEvent::kFail: return JobState::kFailed;
    case JobEvent::kRestart: return JobState::kQueued;
    default: return std::nullopt;
  }
}

std::optional<JobState> from_preparing(JobEvent event) {
  switch (event) {
    case JobEvent::kPrepared: return JobState::kRendering;
    case JobEvent::kCancel: return JobState::kCancelled;
    case JobEvent::kFail: return JobState::kFailed;
    case JobEvent::kRestart: return JobState::kQueued;
    default: return std::nullopt;
  }
}

std::optional<JobState> from_rendering(JobEvent event) {
  switch (event) {
    case JobEvent::kRendered: return JobState::kCompleted;
    case JobEvent::kCancel: return JobState::kCancelling;
    case JobEvent::kFail: return JobState::kFailed;
    case JobEvent::kRestart: return JobState::kQueued;
    default: return std::nullopt;
  }
}

std::optional<JobState> from_cancelling(JobEvent event) {
  // A cancel that the process did not live to finish is finished by the next one.
  if (event == JobEvent::kDrained || event == JobEvent::kRestart) return JobState::kCancelled;
  return std::nullopt;
}

}  // namespace

std::string_view name(JobState state) {
  switch (state) {
    case JobState::kQueued: return "queued";
    case JobState::kPreparing: return "preparing";
    case JobState::kRendering: return "rendering";
    case JobState::kCancelling: return "cancelling";
    case JobState::kCompleted: return "completed";
    case JobState::kFailed: return "failed";
    case JobState::kCancelled: return "cancelled";
  }
  return "";
}

std::optional<JobState> job_state_named(std::string_view text) {
  for (const JobState state : kAllJobStates) {
    if (name(state) == text) return state;
  }
  return std::nullopt;
}

bool is_final(JobState state) {
  return state == JobState::kCompleted || state == JobState::kFailed ||
         state == JobState::kCancelled;
}

std::optional<JobState> next_state(JobState state, JobEvent event) {
  switch (state) {
    case JobState::kQueued: return from_queued(event);
    case JobState::kPreparing: return from_preparing(event);
    case JobState::kRendering: return from_rendering(event);
    case JobState::kCancelling: return from_cancelling(event);
    case JobState::kCompleted:
    case JobState::kFailed:
    case JobState::kCancelled: break;
  }
  return std::nullopt;
}

}  // namespace raykiln::server
