// Jobs that go on from the samples of completed ones.
#include <algorithm>

#include "core.hpp"

namespace raykiln::server {
namespace {

/// Samples a pixel in the tile that has most of them.
std::uint64_t most_samples(const JobSnapshot& job) {
  for (const auto& tiles : {job.tile_samples, job.request.stop.tile_samples}) {
    if (!tiles.empty()) return *std::max_element(tiles.begin(), tiles.end());
  }
  return static_cast<std::uint64_t>(job.progress.samples_per_pixel);
}

}  // namespace

/// The submission that an extension stands for.
Result<SubmitJob> Scheduler::Core::extended(ExtendJob extension) {
  auto earlier = snapshot_of(extension.job);
  if (!earlier) return earlier.error();
  if (earlier->state != JobState::kCompleted) {
    return Error{ErrorKind::kConflict, "job_not_completed",
                 "only a completed job can be extended, this one is " + std::string(name(earlier->state)), ""};
  }
  const StopRule& stop = extension.stop;
  const std::uint64_t there = most_samples(*earlier);
  if (stop.samples <= there) {
    return Error{ErrorKind::kInvalid, "invalid_request",
                 "the job has " + std::to_string(there) + " samples already", "/stop/samples"};
  }
  SubmitJob submission{std::move(earlier->request), std::move(extension.idempotency_key), extension.job};
  submission.request.stop = stop;
  submission.request.reuse = false;
  submission.request.priority = extension.priority.value_or(submission.request.priority);
  return submission;
}

void Scheduler::Core::extend(ExtendJob extension, const Reply<SubmittedJob>& reply) {
  auto submission = extended(std::move(extension));
  if (!submission) return reply(submission.error());
  submit(std::move(*submission), reply);
}

/// Times and curve of the earlier job, whose film and picture are there; its plan is resumed by begin_stops().
void Scheduler::Core::go_on_from(LiveJob& job, KeptFilm kept) {
  JobSnapshot& s = job.snapshot;
  const auto prepared = s.statistics;
  s.statistics = kept.job.statistics;
  s.statistics.tree_build_seconds = prepared.tree_build_seconds;
  s.statistics.tree = prepared.tree;
  s.statistics.film_bytes = prepared.film_bytes;
  s.curve = std::move(kept.job.curve);
  s.forecasts = std::move(kept.job.forecasts);
  s.accuracy = std::move(kept.job.accuracy);
  job.seconds_before = s.statistics.render_seconds;
  job.plan->resume(kept.tile_samples);
  s.continued_samples = static_cast<double>(job.plan->samples_done()) / (double{1} * s.request.width * s.request.height);
  job.new_samples = true;
}

/// Precondition: completed, so that every tile is at the border of a block, or in its incomplete last one,
/// which is rendered anew: all that is judged is then what a whole job would judge.
void Scheduler::Core::keep_film(LiveJob& job, const JobImage& image) {
  job.film->drop_incomplete();
  if (job.layers) job.layers->drop_incomplete();
  let_go(kept_.keep({job.snapshot, job.film, job.plan->tile_samples(), image.seconds, job.layers}));
}

}  // namespace raykiln::server
