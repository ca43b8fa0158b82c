// The states of a job and the only steps between them.
#pragma once

#include <optional>
#include <string_view>

namespace raykiln::server {

/// One spelling everywhere: see name(). README.md has a paragraph for each.
enum class JobState { kQueued, kPreparing, kRendering, kCancelling, kCompleted, kFailed, kCancelled };
inline constexpr JobState kAllJobStates[] = {
    JobState::kQueued,    JobState::kPreparing, JobState::kRendering, JobState::kCancelling,
    JobState::kCompleted, JobState::kFailed,    JobState::kCancelled};

/// What can happen to a job.
enum class JobEvent {
  kStart,            ///< admitted to the active jobs: the scene is being prepared
  kPrepared,         ///< scene and tree are there
  kRendered,         ///< all samples are in the film and the image is stored
  kFail,             ///< cannot go on
  kCancel,           ///< a client asked for it
  kDrained,          ///< no work in flight any more, the partial image is stored
  kRestart,          ///< the daemon started and found the job unfinished
};
inline constexpr JobEvent kAllJobEvents[] = {
    JobEvent::kStart, JobEvent::kPrepared, JobEvent::kRendered, JobEvent::kFail,
    JobEvent::kCancel, JobEvent::kDrained, JobEvent::kRestart};

[[nodiscard]] std::string_view name(JobState state);
[[nodiscard]] std::optional<JobState> job_state_named(std::string_view name);

/// True for completed, failed and cancelled: never left again.
[[nodiscard]] bool is_final(JobState state);

/// The state after `event`, or nothing where the event is refused in `state`.
[[nodiscard]] std::optional<JobState> next_state(JobState state, JobEvent event);

}  // namespace raykiln::server
