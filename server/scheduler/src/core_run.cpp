// From the queue to the last sample.
#include <algorithm>
#include <new>
#include <utility>

#include "core.hpp"
#include "raykiln/scheduler/render_inputs.hpp"
#include "raykiln/workers/effects.hpp"
#include "raykiln/workers/scene_tree.hpp"
#include "raykiln/workers/tile_counts.hpp"

namespace raykiln::server {
namespace {

TaskLength task_length(const SchedulerSettings& settings) {
  TaskLength length;
  length.low_seconds = settings.task_seconds_low;
  length.target_seconds = settings.task_seconds_target;
  length.high_seconds = settings.task_seconds_high;
  return length;
}

std::vector<std::uint32_t> samples_of(const std::vector<render::SampleBlock>& blocks) {
  std::vector<std::uint32_t> samples;
  samples.reserve(blocks.size());
  for (const auto& block : blocks) samples.push_back(static_cast<std::uint32_t>(block.count));
  return samples;
}

std::uint64_t rays_in(const render::TileResult& r) {
  return r.stats.camera_rays + r.stats.bounce_rays + r.stats.shadow_rays;
}

/// Some 200 bytes a pixel: half a second for the largest films, and a tenth to read what another job has left.
Canvas canvas_of(const JobRequest& request, std::optional<KeptFilm> earlier) {
  Canvas canvas;
  if (earlier) {
    canvas.film = std::move(earlier->film);
    canvas.layers = std::move(earlier->layers);
    canvas.picture = canvas.film->resolve();
    canvas.pixel_seconds = std::move(earlier->pixel_seconds);
    canvas.earlier = std::move(earlier);
    return canvas;
  }
  const auto pixels = static_cast<std::size_t>(request.width) * static_cast<std::size_t>(request.height);
  canvas.film = std::make_shared<render::Film>(request.width, request.height, render::sample_relation(sampler_of(request)));
  const auto layers = render::layer_set_of(request.layers).value_or(render::LayerSet());
  if (!layers.empty()) canvas.layers = std::make_shared<render::LayerFilm>(layers, request.width, request.height);
  canvas.picture = {request.width, request.height, std::vector<float>(3 * pixels)};
  canvas.pixel_seconds.assign(pixels, 0.0F);
  return canvas;
}

Error no_memory() { return {ErrorKind::kInternal, "render_failed", "no memory for the film", ""}; }

/// A task's time, spread evenly over its pixels.
void add_pixel_seconds(std::vector<float>& seconds, int width, const TileOutcome& outcome) {
  std::size_t pixels = 0;
  for (const render::TileResult& result : outcome.results) pixels += result.rect.pixels();
  const auto each = static_cast<float>(outcome.seconds / static_cast<double>(std::max<std::size_t>(pixels, 1)));
  for (const render::TileResult& result : outcome.results) {
    for (int y = result.rect.y0; y < result.rect.y1; ++y) {
      const auto row = seconds.begin() + std::ptrdiff_t{y} * width;
      std::for_each(row + result.rect.x0, row + result.rect.x1, [each](float& s) { s += each; });
    }
  }
}

}  // namespace

void Scheduler::Core::pump() {
  if (!halted_) {
    start_jobs();
    dispatch();
  }
  note_busy();
}

void Scheduler::Core::start_jobs() {
  bool started = false;
  while (accepting_ && active_ < config_.scheduler.max_active_jobs && start_next_job()) {
    started = true;
  }
  if (started) tell_queue_positions();
}

/// False when the first job in the queue has to wait. Those behind it wait too, so that a large film
/// is not overtaken for ever.
bool Scheduler::Core::start_next_job() {
  if (queue_.empty()) return false;
  LiveJob& job = *find(queue_.front());
  const std::uint64_t bytes = film_memory(job.snapshot.request);
  if (active_film_bytes_ > 0 && active_film_bytes_ + bytes > config_.scheduler.max_film_bytes) return false;
  ++active_;
  active_film_bytes_ += bytes;
  active_gauge_.set(static_cast<double>(active_));
  job.snapshot.statistics.film_bytes = bytes;
  start_preparing(job);
  return true;
}

void Scheduler::Core::start_preparing(LiveJob& job) {
  const JobId id = job.snapshot.id;
  job.active_since = parts_.clock.steady();
  job.snapshot.started = parts_.clock.wall();
  job.snapshot.prepare = {PrepareStage::kWaiting, 0.0};
  transition(job, JobEvent::kStart);
  job.ticket = parts_.cache.prepare(
      job.snapshot.request.scene, job.snapshot.request.tree,
      [this, strand = strand_, id](PrepareProgress progress) {
        post_on(strand, this, [this, id, progress] {
          LiveJob* waiting = find(id);
          if (waiting == nullptr || waiting->snapshot.state != JobState::kPreparing) return;
          waiting->snapshot.prepare = progress;
          publish_soon(*waiting);
        });
      },
      [this, strand = strand_, id](Result<ReadyScene> scene) {
        post_on(strand, this, [this, id, ready = std::move(scene)]() mutable { prepared(id, std::move(ready)); });
      });
}

void Scheduler::Core::prepared(const JobId& id, Result<ReadyScene> scene) {
  LiveJob* job = find(id);
  if (job == nullptr || job->snapshot.state != JobState::kPreparing || halted_) return;
  job->ticket.reset();
  if (!scene) {
    transition(*job, JobEvent::kFail, scene.error());
    return pump();
  }
  try {
    start_rendering(*job, std::move(*scene));
  } catch (const std::bad_alloc&) {
    job->film.reset();
    job->layers.reset();
    job->picture = {};
    job->plan.reset();
    transition(*job, JobEvent::kFail, no_memory());
  }
  pump();
}

void Scheduler::Core::start_rendering(LiveJob& job, ReadyScene scene) {
  JobSnapshot& s = job.snapshot;
  auto settings = render_settings(s.request, *scene.scene);
  if (!settings) return transition(job, JobEvent::kFail, settings.error());
  job.settings = *settings;
  s.effects = effect_report(render::effect_plan(*settings, *scene.scene));
  warn_of_approximation(s.effects, s.warnings);
  warn_of_light_model(*settings, *scene.scene, s.warnings);
  warn_of_picture(*settings, *scene.scene, scene.tree.stats, s.warnings);
  look_for_missing_light(job, *settings, scene.prepared);
  s.statistics.tree_build_seconds = scene.built_now ? scene.tree.build_seconds : 0.0;
  s.statistics.tree = tree_figures(scene.tree.stats);
  job.scene = std::move(scene);
  job.blocks = render::blocks_for(s.request.stop.samples);
  auto earlier = s.continues.empty() ? std::nullopt : kept_.take(s.continues);
  if (!is_large(job)) {
    Canvas canvas = canvas_of(s.request, std::move(earlier));
    return begin_rendering(job, canvas);
  }
  auto held = std::make_shared<std::optional<KeptFilm>>(std::move(earlier));
  disk_.post([this, id = s.id, request = s.request, held] {
    std::shared_ptr<Canvas> canvas;
    try {
      canvas = std::make_shared<Canvas>(canvas_of(request, std::move(*held)));
    } catch (const std::bad_alloc&) {
      parts_.log.error("no_memory_for_film", {{"job", id}});
    }
    post([this, id, canvas] { canvas_ready(id, canvas); });
  });
}

/// The job may be gone by now, and then its film goes as it came.
void Scheduler::Core::canvas_ready(const JobId& id, const std::shared_ptr<Canvas>& canvas) {
  LiveJob* job = find(id);
  if (job == nullptr || job->snapshot.state != JobState::kPreparing || halted_) return let_go(canvas);
  if (canvas) begin_rendering(*job, *canvas);
  else transition(*job, JobEvent::kFail, no_memory());
  pump();
}

void Scheduler::Core::begin_rendering(LiveJob& job, Canvas& canvas) {
  JobSnapshot& s = job.snapshot;
  job.plan.emplace(s.request.width, s.request.height, s.request.tile, samples_of(job.blocks),
                   task_length(config_.scheduler));
  if (!s.request.stop.tile_samples.empty()) job.plan->set_tile_samples(s.request.stop.tile_samples);
  job.film = std::move(canvas.film);
  job.layers = std::move(canvas.layers);
  job.picture = std::move(canvas.picture);
  job.pixel_seconds = std::move(canvas.pixel_seconds);
  if (canvas.earlier) go_on_from(job, std::move(*canvas.earlier));
  job.render_since = parts_.clock.steady();
  s.statistics.prepare_seconds = seconds_between(job.active_since, job.render_since);
  s.prepare = {};
  transition(job, JobEvent::kPrepared);
  shares_.join(s.id, s.request.priority);
  begin_stops(job);
}

/// Tells light that samples never bring. Found out where it holds up nobody who waits for this strand.
void Scheduler::Core::look_for_missing_light(const LiveJob& of, const render::RenderSettings& settings,
                                             std::shared_ptr<const render::PreparedScene> scene) {
  if (!scene) return;
  disk_.post([this, id = of.snapshot.id, settings, scene, stop = of.stop.get_token()] {
    std::vector<JobWarning> found;
    try {
      warn_of_missing_light(settings, *scene, found, stop);
    } catch (const std::exception& fault) {
      parts_.log.warn("missing_light_not_judged", {{"job", id}, {"why", fault.what()}});
    }
    if (found.empty()) return;
    post([this, id, found] {
      LiveJob* job = find(id);
      if (job == nullptr) return;
      job->snapshot.warnings.insert(job->snapshot.warnings.end(), found.begin(), found.end());
      publish_soon(*job);
    });
  });
}

/// Keeps as many tasks waiting as run, so that no worker waits for this strand.
void Scheduler::Core::dispatch() {
  const auto most = static_cast<std::size_t>(2 * parts_.executor.concurrency() + 1);
  while (in_flight_.size() < most) {
    const auto id = shares_.pick([this](const JobId& candidate) {
      const LiveJob* job = find(candidate);
      return job != nullptr && !job->ending && job->plan && job->plan->has_work();
    });
    if (!id) return;
    dispatch_one(*find(*id));
  }
}

void Scheduler::Core::dispatch_one(LiveJob& job) {
  auto item = job.plan->next();
  if (!item) return;
  shares_.charge(job.snapshot.id, job.plan->expected_seconds(*item));
  TileTask task;
  task.job = job.snapshot.id;
  task.scene = job.scene.prepared;
  task.settings = job.settings;
  task.blocks.assign(job.blocks.begin() + static_cast<std::ptrdiff_t>(item->first_block),
                     job.blocks.begin() + static_cast<std::ptrdiff_t>(item->end_block));
  task.item = std::move(*item);
  task.stop = job.stop.get_token();
  in_flight_.emplace(task.job, task.item.id);
  ++job.in_flight;
  parts_.executor.start(std::move(task), [this, strand = strand_](TileOutcome outcome) {
    post_on(strand, this, [this, held = std::move(outcome)]() mutable { finished_task(std::move(held)); });
  });
}

/// Time of a worker before this task that it could have spent on this job.
void Scheduler::Core::count_idle(LiveJob& job, const TileOutcome& outcome) {
  const SteadyTime from = std::max(outcome.free_since, job.render_since);
  const double idle = seconds_between(from, outcome.begun);
  if (idle > 0.0) job.snapshot.statistics.idle_seconds += idle;
  worker_free_since_[outcome.worker] = outcome.ended;
}

void Scheduler::Core::finished_task(TileOutcome outcome) {
  if (in_flight_.erase({outcome.job, outcome.item.id}) == 0) return;  // answered before
  LiveJob* job = find(outcome.job);
  if (job != nullptr && !halted_) {
    --job->in_flight;
    if (outcome.begun != SteadyTime{}) count_idle(*job, outcome);
    job->snapshot.statistics.worker_seconds += outcome.seconds;
    if (job->ending) {
      archive_if_drained(*job);
    } else if (outcome.error || outcome.stopped) {
      task_failed(*job, outcome);
    } else {
      merge_outcome(*job, outcome);
    }
  }
  pump();
}

void Scheduler::Core::merge_outcome(LiveJob& job, const TileOutcome& outcome) {
  if (!job.plan->in_flight(outcome.item)) return;  // late or twice: it is in the film already
  JobStatistics& statistics = job.snapshot.statistics;
  const SteadyTime begin = parts_.clock.steady();
  shares_.charge(job.snapshot.id, outcome.seconds - job.plan->expected_seconds(outcome.item));
  add_pixel_seconds(job.pixel_seconds, job.settings.width, outcome);
  for (const render::TileResult& result : outcome.results) {
    render::merge(*job.film, result);
    if (job.layers) render::merge(*job.layers, result);
    job.film->resolve(result.rect, job.picture);
    add_counts(statistics, result);
    rays_.add(static_cast<double>(rays_in(result)));
    samples_.add(static_cast<double>(result.stats.paths));
    non_finite_.add(static_cast<double>(result.stats.non_finite));
  }
  (void)job.plan->merged(outcome.item, outcome.seconds);
  ++statistics.tasks;
  tasks_.add();
  task_seconds_.observe(outcome.seconds);
  job.new_samples = true;
  statistics.merge_seconds += seconds_between(begin, parts_.clock.steady());
  if (job.plan->at_rest()) return rest(job);
  publish_soon(job);
}

void Scheduler::Core::task_failed(LiveJob& job, const TileOutcome& outcome) {
  const Error reason = outcome.error.value_or(
      Error{ErrorKind::kInternal, "render_failed", "a worker stopped without being asked", ""});
  parts_.log.warn("task_failed", {{"job", outcome.job},
                                  {"attempt", outcome.item.attempt},
                                  {"why", reason.message}});
  if (outcome.item.attempt < config_.scheduler.max_attempts) {
    ++job.snapshot.statistics.retried_tasks;
    (void)job.plan->failed(outcome.item);
    return;
  }
  begin_ending(job, JobEvent::kFail,
               Error{ErrorKind::kInternal, "render_failed",
                     reason.message + " (after " + std::to_string(outcome.item.attempt) +
                         " attempts)",
                     ""});
}

}  // namespace raykiln::server
