// Start and end.
#include <algorithm>
#include <limits>

#include "core.hpp"

namespace raykiln::server {

Scheduler::Core::Core(const Config& config, const Parts& parts)
    : config_(config),
      parts_(parts),
      hub_(config.http.max_watchers),
      kept_(config.scheduler.max_kept_film_bytes),
      queued_gauge_(parts.metrics.gauge("raykiln_jobs_queued", "jobs that wait")),
      active_gauge_(parts.metrics.gauge("raykiln_jobs_active", "jobs preparing or rendering")),
      rays_(parts.metrics.counter("raykiln_rays_total", "rays that were traced")),
      non_finite_(parts.metrics.counter("raykiln_non_finite_samples_total", "samples dropped")),
      tasks_(parts.metrics.counter("raykiln_tasks_total", "tasks merged into films")),
      samples_(parts.metrics.counter("raykiln_samples_total", "samples of pixels that were rendered")),
      reused_(parts.metrics.counter("raykiln_results_reused_total", "jobs answered with a picture that was there")),
      task_seconds_(parts.metrics.histogram("raykiln_task_seconds", "time of one task on a worker",
                                            {0.001, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 1.0})),
      strand_(std::make_shared<SerialThread>("scheduler")),
      disk_("disk"),
      intake_("intake") {}

bool Scheduler::Core::post_on(const std::shared_ptr<SerialThread>& strand, Core* core,
                              std::function<void()> step) {
  // `core` is read by the closure only, and those run while the scheduler lives.
  return strand->post([core, run = std::move(step)] {
    try {
      run();
    } catch (const std::exception& fault) {
      // The border of one step: the daemon outlives it.
      core->parts_.log.error("fault_on_the_strand", {{"why", fault.what()}});
    }
  });
}

/// Jobs that a process before this one did not end start anew, in their old order.
void Scheduler::Core::restore() {
  JobQuery query;
  query.states = {JobState::kQueued, JobState::kPreparing, JobState::kRendering,
                  JobState::kCancelling};
  query.limit = std::numeric_limits<std::int32_t>::max();
  auto records = parts_.store.jobs(query);
  if (!records) {
    parts_.log.error("jobs_not_restored", {{"why", records.error().message}});
    return;
  }
  for (auto record = records->rbegin(); record != records->rend(); ++record) {
    auto decoded = decode_job(record->content);
    if (!decoded) {
      parts_.log.error("job_record_damaged", {{"job", record->id}});
      continue;
    }
    auto fresh = std::make_unique<LiveJob>();
    fresh->snapshot = std::move(*decoded);
    fresh->idempotency_key = record->idempotency_key;
    fresh->request_digest = record->request_digest;
    // It runs again from its start: what it makes is this engine's.
    fresh->result_digest = result_digest(fresh->snapshot.request, config_.engine);
    LiveJob& job = *fresh;
    live_[record->id] = std::move(fresh);
    const bool runs_again = job.snapshot.state != JobState::kCancelling;
    if (runs_again) {
      job.snapshot.started.reset();
      job.snapshot.statistics = {};
      job.snapshot.accuracy.reset();
      job.snapshot.curve.clear();
      job.snapshot.forecasts.clear();
      job.snapshot.continued_samples = 0.0;  // films do not outlive a process
      job.snapshot.progress.samples_done = 0;
      job.snapshot.progress.stop_fraction = 0.0;
      job.snapshot.progress.tiles_started = job.snapshot.progress.tiles_done = 0;
      job.snapshot.progress.samples_per_pixel = 0.0;
      job.snapshot.elapsed_seconds = 0.0;
      job.snapshot.image_revision = 0;
      enqueue(job);
    } else {
      // It had a place among the active ones, which leave() is to give back.
      ++active_;
      active_film_bytes_ += job.snapshot.statistics.film_bytes;
      job.snapshot.image_revision = 0;
    }
    transition(job, JobEvent::kRestart);
    if (runs_again && job.snapshot.state == JobState::kQueued) {
      if (std::find(queue_.begin(), queue_.end(), job.snapshot.id) == queue_.end()) enqueue(job);
    }
  }
  pump();
}

/// Lets shutdown() see whether something is under way.
void Scheduler::Core::note_busy() {
  const std::scoped_lock lock(idle_mutex_);
  busy_ = (halted_ ? 0 : active_) + in_flight_.size();
  if (busy_ == 0) idle_.notify_all();
}

void Scheduler::Core::shutdown(std::chrono::milliseconds drain) {
  post([this] {
    accepting_ = false;
    note_busy();
  });
  // Everything that was posted before has run when this has.
  const auto settled = [this] { return busy_ == 0; };
  {
    std::mutex done_mutex;
    std::condition_variable done;
    bool ran = false;
    if (post([&] {
          const std::scoped_lock lock(done_mutex);
          ran = true;
          done.notify_all();
        })) {
      std::unique_lock lock(done_mutex);
      done.wait(lock, [&] { return ran; });
    }
  }
  {
    std::unique_lock lock(idle_mutex_);
    idle_.wait_until(lock, std::chrono::steady_clock::now() + drain, settled);
  }
  post([this] {
    halted_ = true;
    prepares_.clear();
    for (auto& entry : live_) {
      entry.second->ticket.reset();
      entry.second->stop.request_stop();
    }
    note_busy();
  });
  {
    std::unique_lock lock(idle_mutex_);
    // Workers answer every task, and soon after a stop: this ends.
    idle_.wait(lock, [this] { return busy_ == 0; });
  }
  intake_.stop();
  disk_.stop();
  strand_->stop();
}

}  // namespace raykiln::server
