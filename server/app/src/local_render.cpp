#include "raykiln/app/local_render.hpp"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>

#include "load_here.hpp"
#include "raykiln/accuracy/pixel_error.hpp"
#include "raykiln/render/render.hpp"
#include "raykiln/scheduler/judge_picture.hpp"
#include "raykiln/scheduler/layers.hpp"
#include "raykiln/scheduler/render_inputs.hpp"
#include "raykiln/workers/effects.hpp"
#include "raykiln/workers/scene_tree.hpp"
#include "raykiln/workers/tile_counts.hpp"

namespace raykiln::server {
namespace {

using Steady = std::chrono::steady_clock;

/// Results on their way from the pool's threads to the one that folds them.
class Outbox {
 public:
  void put(TileOutcome outcome) {
    const std::lock_guard lock(mutex_);
    outcomes_.push_back(std::move(outcome));
    ready_.notify_one();
  }
  TileOutcome take() {
    std::unique_lock lock(mutex_);
    ready_.wait(lock, [this] { return !outcomes_.empty(); });
    auto outcome = std::move(outcomes_.front());
    outcomes_.pop_front();
    return outcome;
  }

 private:
  std::mutex mutex_;
  std::condition_variable ready_;
  std::deque<TileOutcome> outcomes_;
};

void add(JobStatistics& sum, const TileOutcome& outcome) {
  sum.worker_seconds += outcome.seconds;
  ++sum.tasks;
  for (const auto& result : outcome.results) add_counts(sum, result);
}

std::vector<std::uint32_t> block_sizes(const std::vector<render::SampleBlock>& blocks) {
  std::vector<std::uint32_t> sizes;
  sizes.reserve(blocks.size());
  for (const auto& block : blocks) sizes.push_back(static_cast<std::uint32_t>(block.count));
  return sizes;
}

/// The plan decides, the pool renders, this thread folds and shows.
class LocalJob {
 public:
  LocalJob(std::shared_ptr<const render::PreparedScene> scene, render::RenderSettings settings,
           const JobRequest& request, LocalPool& pool)
      : scene_(std::move(scene)),
        settings_(settings),
        request_(request),
        pool_(pool),
        adaptive_(request.adaptive),
        blocks_(render::blocks_for(request.stop.samples)),
        plan_(request.width, request.height, request.tile, block_sizes(blocks_),
              TaskLength{}),
        film_(render::make_film(settings_)),
        layers_(settings_.layers, settings_.width, settings_.height) {
    const StopRule& stop = request.stop;
    if (!stop.tile_samples.empty()) plan_.set_tile_samples(stop.tile_samples);
    if (stop.error && !adaptive_) plan_.set_limit(plan_.blocks_for(kErrorFloor));
    if (adaptive_) plan_.set_tile_limits(std::vector<std::uint64_t>(static_cast<std::size_t>(plan_.tiles()), kErrorFloor));
  }

  /// The first fault of a worker, or success.
  Status run(const std::function<void(const ProgressState&)>& progress) {
    begun_ = Steady::now();
    auto shown = begun_;
    std::optional<Error> fault;
    while (true) {
      if (!fault) feed();
      if (plan_.items_in_flight() == 0) {
        if (fault || !goes_on()) break;
        continue;
      }
      const TileOutcome outcome = outbox_.take();
      if (outcome.error && !fault) fault = outcome.error;
      fold(outcome);
      if (Steady::now() - shown < std::chrono::milliseconds(100)) continue;
      shown = Steady::now();
      progress(state());
    }
    statistics_.render_seconds = seconds();
    if (fault) return *fault;
    judge();
    progress(state());
    return success();
  }

  [[nodiscard]] const render::Film& film() const { return film_; }
  [[nodiscard]] const render::LayerFilm& layers() const { return layers_; }
  [[nodiscard]] const JobStatistics& statistics() const { return statistics_; }
  /// What ended it, its error, and the samples of its tiles where they differ.
  void tell(JobSnapshot& job) const {
    job.done_by = done_by_;
    job.accuracy = accuracy_;
    auto samples = plan_.tile_samples();
    const bool even = std::all_of(samples.begin(), samples.end(), [&](auto n) { return n == samples[0]; });
    if ((adaptive_ || done_by_ == DoneBy::kSeconds) && !even) job.tile_samples = std::move(samples);
  }
  [[nodiscard]] RenderProgress progress() const {
    RenderProgress p;
    p.samples_done = plan_.samples_done();
    p.samples_target = plan_.samples_target();
    p.samples_per_pixel = static_cast<double>(p.samples_done) / (double{1} * request_.width * request_.height);
    p.stop_fraction = stop_fraction();
    p.tiles = plan_.tiles();
    p.tiles_started = plan_.tiles_started();
    p.tiles_done = plan_.tiles_done();
    return p;
  }

 private:
  /// Nothing is in flight: what ended the job, or more blocks to render.
  bool goes_on() {
    if (plan_.done()) done_by_ = DoneBy::kSamples;
    else if (plan_.closed()) done_by_ = DoneBy::kSeconds;
    if (done_by_ != DoneBy::kNone) return false;
    const Decision decision = decide(film_, request_);
    accuracy_ = decision.error;
    if (target_met(request_.stop, *accuracy_)) done_by_ = DoneBy::kError;
    if (done_by_ != DoneBy::kNone) return false;
    if (adaptive_) return place_samples(decision.samples);
    const render::SampleBlock& last = blocks_[plan_.limit() - 1];
    plan_.set_limit(plan_.blocks_for(next_decision(last.first + last.count)));
    return true;
  }

  void judge() {
    accuracy_ = judge_picture(film_, request_.pixel_mode == PixelMode::kRandom);
    mark_adaptive(*accuracy_, request_);
  }

  bool place_samples(const std::vector<std::uint64_t>& samples) {
    plan_.set_tile_limits(samples);
    if (plan_.has_work()) return true;
    auto more = plan_.tile_samples();  // samples that were dropped may hide where a tile is
    for (std::uint64_t& n : more) n += render::sample_block(5).count;
    plan_.set_tile_limits(more);
    return true;
  }

  [[nodiscard]] double stop_fraction() const {
    if (done_by_ != DoneBy::kNone) return 1.0;
    const StopRule& stop = request_.stop;
    const double by_time = stop.seconds ? std::min(0.99, seconds() / *stop.seconds) : 0.0;
    return std::max(by_time, accuracy_ ? target_fraction(stop, *accuracy_) : 0.0);
  }

  void feed() {
    if (request_.stop.seconds && seconds() >= *request_.stop.seconds && !plan_.closed()) plan_.close();
    // One more than there are workers, so that none waits for this thread.
    const auto most = static_cast<std::size_t>(pool_.concurrency()) + 2;
    while (plan_.items_in_flight() < most) {
      auto item = plan_.next();
      if (!item) return;
      TileTask task;
      task.scene = scene_;
      task.settings = settings_;
      task.blocks.assign(blocks_.begin() + static_cast<std::ptrdiff_t>(item->first_block),
                         blocks_.begin() + static_cast<std::ptrdiff_t>(item->end_block));
      task.item = std::move(*item);
      pool_.start(std::move(task), [this](TileOutcome outcome) { outbox_.put(std::move(outcome)); });
    }
  }

  void fold(const TileOutcome& outcome) {
    const auto start = Steady::now();
    if (!outcome.error) {
      for (const auto& result : outcome.results) {
        render::merge(film_, result);
        render::merge(layers_, result);
      }
    }
    plan_.merged(outcome.item, outcome.seconds);
    add(statistics_, outcome);
    statistics_.merge_seconds += std::chrono::duration<double>(Steady::now() - start).count();
  }

  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(Steady::now() - begun_).count();
  }

  [[nodiscard]] ProgressState state() const {
    const RenderProgress p = progress();
    ProgressState s;
    s.stage = "rendering";
    s.fraction = p.fraction();
    s.samples_done = p.samples_per_pixel;
    s.samples_target = static_cast<double>(request_.stop.samples);
    s.elapsed_seconds = seconds();
    if (s.fraction > 0.0) s.remaining_seconds = s.elapsed_seconds * (1.0 - s.fraction) / s.fraction;
    s.rays_per_second = static_cast<double>(statistics_.rays()) / std::max(s.elapsed_seconds, 1e-9);
    return s;
  }

  std::shared_ptr<const render::PreparedScene> scene_;
  render::RenderSettings settings_;
  const JobRequest& request_;
  LocalPool& pool_;
  bool adaptive_;
  std::vector<render::SampleBlock> blocks_;
  TilePlan plan_;
  render::Film film_;
  render::LayerFilm layers_;
  Outbox outbox_;
  JobStatistics statistics_;
  DoneBy done_by_ = DoneBy::kNone;
  std::optional<PictureError> accuracy_;
  Steady::time_point begun_;
};

std::vector<JobWarning> warnings_of(const SceneReport& report) {
  std::vector<JobWarning> warnings;
  for (const auto& warning : report.warnings) {
    const bool both = !warning.file.empty() && !warning.where.empty();
    warnings.push_back({warning.code, warning.message,
                        warning.file + (both ? ":" : "") + warning.where});
  }
  return warnings;
}

}  // namespace

Result<LocalPicture> render_locally(const ScenePackage& package, const JobRequest& request,
                                    LocalPool& pool,
                                    const std::function<void(const ProgressState&)>& progress) {
  const auto begun = Steady::now();
  const auto since = [&] { return std::chrono::duration<double>(Steady::now() - begun).count(); };
  progress({.stage = "importing"});
  const auto loaded = load_here(package);
  if (!loaded) return loaded.error();
  const auto settings = render_settings(request, *loaded->scene);
  if (!settings) return settings.error();
  if (auto fits = check_tree_budget(*loaded->scene, request.tree); !fits) return fits.error();

  const auto build_begun = since();
  const auto runner = pool.task_runner(
      [&](double fraction) {
        progress({.stage = "building", .fraction = fraction, .elapsed_seconds = since()});
      },
      {});
  const TreeBudget budget = settled_budget(*loaded->scene, request.tree, WorkerSettings().wide_tree_bytes);
  auto tree = build_tree(*loaded->scene, budget, *runner);
  const double build_seconds = since() - build_begun;
  const render::BuildStats tree_stats = render::build_stats(*tree);
  const auto prepared = render::prepare(loaded->scene, std::move(tree));
  LocalJob job(prepared, *settings, request, pool);
  const double prepare_seconds = since();
  if (auto status = job.run(progress); !status) return status.error();

  LocalPicture picture;
  picture.image = job.film().resolve();
  const auto errors = render::pixel_errors(job.film()).standard_error;
  for (const double e : errors) picture.error.push_back(static_cast<float>(e));
  for (const double n : job.film().plane("samples")) picture.samples.push_back(static_cast<float>(n));
  picture.layers = resolved(&job.layers(), picture.samples);
  picture.job.request = request;
  picture.job.state = JobState::kCompleted;
  picture.job.progress = job.progress();
  picture.job.statistics = job.statistics();
  job.tell(picture.job);
  picture.job.statistics.prepare_seconds = prepare_seconds;
  picture.job.statistics.tree_build_seconds = build_seconds;
  picture.job.statistics.tree = tree_figures(tree_stats);
  picture.job.elapsed_seconds = since();
  picture.job.warnings = warnings_of(loaded->report);
  picture.job.effects = effect_report(render::effect_plan(*settings, *loaded->scene));
  warn_of_approximation(picture.job.effects, picture.job.warnings);
  warn_of_light_model(*settings, *loaded->scene, picture.job.warnings);
  warn_of_picture(*settings, *loaded->scene, tree_stats, picture.job.warnings);
  warn_of_missing_light(*settings, *prepared, picture.job.warnings);
  return picture;
}

}  // namespace raykiln::server
