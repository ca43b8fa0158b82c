// The error of pictures while they are rendered, and the stops that depend on error and time.
#include <algorithm>
#include <cmath>

#include "core.hpp"
#include "raykiln/scheduler/judge_picture.hpp"

namespace raykiln::server {
namespace {

/// Looks follow at least so far apart, as a ratio of render seconds.
constexpr double kStep = 1.1;

bool samples_area(const JobSnapshot& job) { return job.request.pixel_mode == PixelMode::kRandom; }

/// The first decision beyond what is rendered: at borders of blocks, each from the one before.
std::size_t decision_after(const LiveJob& job) {
  std::size_t block = job.plan->blocks_for(kErrorFloor);
  while (block <= job.plan->limit() && block < job.blocks.size()) {
    const render::SampleBlock& last = job.blocks[block - 1];
    block = job.plan->blocks_for(next_decision(last.first + last.count));
  }
  return block;
}

}  // namespace

void Scheduler::Core::begin_stops(LiveJob& job) {
  const StopRule& stop = job.snapshot.request.stop;
  // A job that goes on is judged where it is; then where it would have been judged from its beginning.
  if (job.snapshot.request.adaptive) {
    job.plan->set_tile_limits(std::vector<std::uint64_t>(static_cast<std::size_t>(job.plan->tiles()), kErrorFloor));
  } else if (stop.error) job.plan->set_limit(std::max(job.plan->blocks_for(kErrorFloor), job.plan->furthest_block()));
  if (stop.seconds) {
    const JobId id = job.snapshot.id;
    const auto wait = std::chrono::milliseconds(static_cast<std::int64_t>(std::ceil(1000.0 * std::max(0.0, *stop.seconds - job.seconds_before))));
    strand_->post_after(wait, [this, id] { time_is_up(id); });
  }
  if (job.plan->at_rest()) rest(job);
}

/// What has begun goes on to the border of a block: at most one pass of each tile in flight.
void Scheduler::Core::time_is_up(const JobId& id) {
  LiveJob* job = find(id);
  if (job == nullptr || !job->plan || job->ending || halted_) return;
  job->plan->close();
  if (job->plan->at_rest()) rest(*job);
}

/// Nothing of the job is in flight and nothing can be handed out: every pixel of a tile is at the
/// same border of a block. What is decided here depends on merged samples alone.
void Scheduler::Core::rest(LiveJob& job) {
  if (job.deciding) return;  // decided() comes back here
  if (job.plan->done()) return finish(job, DoneBy::kSamples);
  if (job.plan->closed()) return finish(job, DoneBy::kSeconds);
  refresh(job);
  const JobStatistics& then = job.snapshot.statistics;
  if (!is_large(job)) {
    const SteadyTime begin = parts_.clock.steady();
    auto decision = decide(*job.film, job.snapshot.request);
    return decided(job, std::move(decision), seconds_between(begin, parts_.clock.steady()), then);
  }
  // Seconds for the largest films. Nobody writes into this one until decided() hands out more of it.
  job.deciding = true;
  disk_.post([this, id = job.snapshot.id, film = std::shared_ptr<const render::Film>(job.film),
              request = job.snapshot.request, then] {
    const SteadyTime begin = parts_.clock.steady();
    std::optional<Decision> decision;
    try {
      decision = decide(*film, request);
    } catch (const std::exception& fault) {
      parts_.log.error("error_not_judged", {{"job", id}, {"why", fault.what()}});
    }
    const double seconds = seconds_between(begin, parts_.clock.steady());
    post([this, id, decision, seconds, then] {
      LiveJob* waiting = find(id);
      if (waiting == nullptr || !waiting->deciding || halted_) return;
      waiting->deciding = false;
      if (waiting->ending) return;  // cancelled meanwhile
      if (decision) decided(*waiting, *decision, seconds, then);
      else begin_ending(*waiting, JobEvent::kFail, Error{ErrorKind::kInternal, "render_failed", "no memory to judge the picture", ""});
      pump();
    });
  });
}

/// `then`: of the samples that were judged.
void Scheduler::Core::decided(LiveJob& job, Decision decision, double seconds, JobStatistics then) {
  note_error(job, std::move(decision.error), then);
  job.snapshot.statistics.accuracy_seconds += seconds;
  if (target_met(job.snapshot.request.stop, *job.snapshot.accuracy)) return finish(job, DoneBy::kError);
  if (job.plan->closed()) return rest(job);  // the time was up meanwhile
  if (job.snapshot.request.adaptive) return place_samples(job, decision.samples);
  job.plan->set_limit(decision_after(job));
  publish_soon(job);
}

/// What this picks depends on merged samples alone, and so do the bytes of an adaptive picture.
void Scheduler::Core::place_samples(LiveJob& job, const std::vector<std::uint64_t>& samples) {
  job.plan->set_tile_limits(samples);
  if (!job.plan->has_work()) {  // a block more for each: samples that were dropped may hide where a tile is
    auto more = job.plan->tile_samples();
    for (std::uint64_t& n : more) n += render::sample_block(5).count;
    job.plan->set_tile_limits(more);
  }
  if (job.plan->at_rest()) return rest(job);
  publish_soon(job);
}

void Scheduler::Core::finish(LiveJob& job, DoneBy by) {
  JobSnapshot& s = job.snapshot;
  refresh(job);
  if (s.progress.samples_done == 0) {  // other jobs had the workers all the time
    return begin_ending(job, JobEvent::kFail,
                        Error{ErrorKind::kUnavailable, "no_samples",
                              "the time was over before a worker was free: ask for more seconds", "/stop/seconds"});
  }
  s.done_by = by;
  s.progress.stop_fraction = 1.0;
  auto samples = job.plan->tile_samples();
  const bool even = std::all_of(samples.begin(), samples.end(), [&](std::uint64_t n) { return n == samples[0]; });
  if ((by == DoneBy::kSeconds || s.request.adaptive) && !even) s.tile_samples = std::move(samples);
  begin_ending(job, JobEvent::kRendered, std::nullopt);
}

void Scheduler::Core::measure_if_due(LiveJob& job) {
  JobSnapshot& s = job.snapshot;
  if (!(config_.scheduler.look_share > 0.0) || !job.plan || job.ending || job.deciding || !job.new_samples) return;
  refresh(job);
  const double now = s.statistics.render_seconds;
  const bool whole = s.progress.tiles_started == s.progress.tiles && s.progress.samples_per_pixel >= 2.0;
  const bool newer = s.curve.empty() || now > s.curve.back().render_seconds;
  if (!whole || !newer || now < job.measure_at) return;
  const SteadyTime begin = parts_.clock.steady();
  note_error(job, look_at_picture(*job.film, samples_area(s)), s.statistics);
  const double cost = seconds_between(begin, parts_.clock.steady());
  s.statistics.accuracy_seconds += cost;
  job.measure_at = std::max(kStep * now, now + cost / config_.scheduler.look_share);
}

void Scheduler::Core::note_error(LiveJob& job, PictureError error, const JobStatistics& then) {
  JobSnapshot& s = job.snapshot;
  mark_adaptive(error, s.request);
  if (error.known()) {
    add_point(s.curve, {.render_seconds = then.render_seconds,
                        .worker_seconds = then.worker_seconds,
                        .samples = error.mean_samples,
                        .rays = then.rays(),
                        .error = error.error});
    for (const Forecast& scored : update_forecasts(s.forecasts, s.curve, basis_of(error))) {
      parts_.metrics
          .counter("raykiln_forecasts_total", "forecasts of the time to half an error, by whether they held",
                   {{"hit", scored.hit() ? "true" : "false"}})
          .add();
    }
    s.progress.stop_fraction =
        std::max(s.progress.stop_fraction, target_fraction(s.request.stop, error));
  }
  s.accuracy = std::move(error);
}

}  // namespace raykiln::server
