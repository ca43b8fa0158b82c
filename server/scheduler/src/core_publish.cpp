// Changes of state, revisions, and who hears of them.
#include <algorithm>

#include "core.hpp"

namespace raykiln::server {
namespace {

JobStatistics with_time(JobStatistics statistics, double render_seconds) {
  statistics.render_seconds = render_seconds;
  return statistics;
}

}  // namespace

/// Brings those fields of the snapshot up to date that follow from other things.
void Scheduler::Core::refresh(LiveJob& job) {
  JobSnapshot& s = job.snapshot;
  const SteadyTime now = parts_.clock.steady();
  s.queue_position.reset();
  if (s.state == JobState::kQueued) {
    const auto place = std::find(queue_.begin(), queue_.end(), s.id);
    s.queue_position = static_cast<std::size_t>(place - queue_.begin());
  }
  if (s.started && !is_final(s.state)) s.elapsed_seconds = seconds_between(job.active_since, now);
  s.remaining_seconds.reset();
  if (!job.plan) return;
  if (!job.ending) {
    s.statistics = with_time(std::move(s.statistics), job.seconds_before + seconds_between(job.render_since, now));
    s.progress.tiles = job.plan->tiles();
    s.progress.tiles_started = job.plan->tiles_started();
    s.progress.tiles_done = job.plan->tiles_done();
    s.progress.samples_done = job.plan->samples_done();
    s.progress.samples_target = job.plan->samples_target();
    s.progress.samples_per_pixel = static_cast<double>(s.progress.samples_done) /
                                   (double{1} * s.request.width * s.request.height);
  }
  if (!job.ending && s.request.stop.seconds) {
    s.progress.stop_fraction = std::max(s.progress.stop_fraction,
                                        std::min(0.99, s.statistics.render_seconds / *s.request.stop.seconds));
  }
  const double fraction = s.progress.fraction();
  if (s.state == JobState::kRendering && fraction > 0.0) {
    s.remaining_seconds = s.statistics.render_seconds * (1.0 - fraction) / fraction;
  }
}

void Scheduler::Core::save(const LiveJob& job) {
  const JobSnapshot& s = job.snapshot;
  const auto stored =
      parts_.store.put_job({s.id, s.state, s.revision, s.request.scene, s.created,
                            parts_.clock.wall(), job.idempotency_key, job.request_digest,
                            encode_job(s), job.result_digest});
  // The job goes on: a restart would find the state before and run it again, which is harmless.
  if (!stored) {
    parts_.log.error("job_not_stored", {{"job", s.id}, {"why", stored.error().message}});
  }
}

void Scheduler::Core::publish(LiveJob& job) {
  const SteadyTime begin = parts_.clock.steady();
  refresh(job);
  job.published_at = begin;
  hub_.publish(std::make_shared<const JobSnapshot>(job.snapshot));
  job.snapshot.statistics.publish_seconds += seconds_between(begin, parts_.clock.steady());
}

void Scheduler::Core::transition(LiveJob& job, JobEvent event, std::optional<Error> error) {
  JobSnapshot& s = job.snapshot;
  const auto next = next_state(s.state, event);
  if (!next) {
    parts_.log.error("transition_refused", {{"job", s.id}, {"state", name(s.state)}});
    return;
  }
  parts_.log.info("job_state", {{"job", s.id}, {"from", name(s.state)}, {"to", name(*next)}});
  refresh(job);
  const JobState before = s.state;
  s.state = *next;
  ++s.revision;
  if (before == JobState::kQueued) std::erase(queue_, s.id);
  if (is_final(s.state)) {
    s.finished = parts_.clock.wall();
    s.prepare = {};
    s.error = std::move(error);
    if (job.film && s.progress.samples_done > 0) s.image_revision = s.revision;
  }
  refresh(job);
  save(job);
  publish(job);
  if (is_final(s.state)) leave(job);
}

/// The job has reached its final state: what it held is given back. `job` dies here.
void Scheduler::Core::leave(LiveJob& job) {
  const JobId id = job.snapshot.id;
  shares_.leave(id);
  if (job.snapshot.started) {
    --active_;
    if (!job.stored_later) active_film_bytes_ -= job.snapshot.statistics.film_bytes;
    const double seconds = job.snapshot.elapsed_seconds;
    mean_job_seconds_ = mean_job_seconds_ > 0.0 ? 0.7 * mean_job_seconds_ + 0.3 * seconds : seconds;
  }
  parts_.metrics
      .counter("raykiln_jobs_finished_total", "jobs by their final state",
               {{"state", std::string(name(job.snapshot.state))}})
      .add();
  active_gauge_.set(static_cast<double>(active_));
  job.ticket.reset();
  job.stop.request_stop();
  if (job.film) let_go(std::move(job.film));
  if (job.layers) let_go(std::move(job.layers));
  live_.erase(id);
  note_busy();
  if (auto pruned = parts_.store.prune_jobs(config_.scheduler.max_kept_jobs); !pruned) {
    parts_.log.warn("jobs_not_pruned", {{"why", pruned.error().message}});
  }
  tell_queue_positions();
}

/// A revision of progress, at once or when the interval since the last one has passed.
void Scheduler::Core::publish_soon(LiveJob& job) {
  if (job.publish_planned || job.ending) return;
  job.publish_planned = true;
  using std::chrono::milliseconds;
  const auto since = parts_.clock.steady() - job.published_at;
  const auto wait = std::max(milliseconds(0),
                             config_.scheduler.publish_interval -
                                 std::chrono::duration_cast<milliseconds>(since));
  const JobId id = job.snapshot.id;
  strand_->post_after(wait, [this, id] {
    LiveJob* late = find(id);
    if (late == nullptr) return;
    late->publish_planned = false;
    if (late->ending || halted_) return;
    measure_if_due(*late);
    ++late->snapshot.revision;
    if (std::exchange(late->new_samples, false)) {
      late->snapshot.image_revision = late->snapshot.revision;
    }
    publish(*late);
  });
}

/// Those who wait hear when their place has changed.
void Scheduler::Core::tell_queue_positions() {
  queued_gauge_.set(static_cast<double>(queue_.size()));
  for (std::size_t i = 0; i < queue_.size(); ++i) {
    LiveJob& job = *find(queue_[i]);
    if (job.snapshot.queue_position == i) continue;
    ++job.snapshot.revision;
    publish(job);
  }
}

}  // namespace raykiln::server
