// The inside of the scheduler: everything here happens on its strand unless said otherwise.
#pragma once

#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <stop_token>
#include <string>
#include <vector>

#include "kept_films.hpp"
#include "raykiln/base/serial_thread.hpp"
#include "raykiln/jobs/fair_share.hpp"
#include "raykiln/jobs/tile_plan.hpp"
#include "raykiln/scheduler/judge_picture.hpp"
#include "raykiln/scheduler/scheduler.hpp"

namespace raykiln::server {

/// What a job renders into: empty, or what another job has left.
struct Canvas {
  std::shared_ptr<render::Film> film;
  std::shared_ptr<render::LayerFilm> layers;  ///< null where none is asked for
  render::Image picture;
  std::vector<float> pixel_seconds;
  std::optional<KeptFilm> earlier;  ///< the job that it goes on from; film, layers and seconds of that are the ones above
};

/// A picture that is made strip by strip beside its rendering, and who waits for it.
struct Gathering {
  std::shared_ptr<JobImage> image;
  int rows = 0;  ///< that are in it
  std::vector<Reply<JobImagePtr>> waiting;
};

/// A scene that is made ready because a client asked for it; or why it was not, until the client asks again.
struct Preparing {
  std::unique_ptr<PrepareTicket> ticket;
  std::optional<Error> fault{};
};

/// A job that has not ended.
struct LiveJob {
  JobSnapshot snapshot;
  std::string idempotency_key, request_digest, result_digest;
  std::uint64_t order = 0;  ///< of submission

  // While active.
  std::unique_ptr<PrepareTicket> ticket;
  ReadyScene scene;
  render::RenderSettings settings;
  std::vector<render::SampleBlock> blocks;
  std::shared_ptr<render::Film> film;  ///< shared with what stores it, once nothing is merged any more
  std::shared_ptr<render::LayerFilm> layers;  ///< beside the film; null where none is asked for
  render::Image picture;  ///< of the film as it is: kept up to date tile by tile
  std::optional<TilePlan> plan;
  std::stop_source stop;
  int in_flight = 0;
  SteadyTime active_since{}, render_since{};
  double seconds_before = 0.0;  ///< render seconds of the jobs that this one goes on from

  // Publication.
  bool new_samples = false;        ///< since the last revision
  bool publish_planned = false;
  SteadyTime published_at{};

  // The error of the picture.
  bool deciding = false;    ///< the film is being judged, and nothing of it is in flight
  double measure_at = 0.0;  ///< render seconds from which it is judged anew
  std::vector<float> pixel_seconds;  ///< of workers
  std::shared_ptr<Gathering> gathering;  ///< of its layers, while they are; null else

  // On its way to a final state.
  std::optional<JobEvent> ending{};
  std::optional<Error> ending_error{};
  bool archiving = false;
  JobImagePtr last_picture;  ///< from `archiving` on, in place of `picture`
  bool stored_later = false;  ///< its picture and film are in use beyond its end
};

class Scheduler::Core {
 public:
  Core(const Config& config, const Parts& parts);

  /// Runs `step` on the strand; from any thread. False when it has stopped.
  bool post(std::function<void()> step) { return post_on(strand_, this, std::move(step)); }
  /// The same for callbacks that may come after the scheduler is gone: they hold the strand, which
  /// drops the step then.
  static bool post_on(const std::shared_ptr<SerialThread>& strand, Core* core,
                      std::function<void()> step);

  // core_jobs.cpp
  void submit(SubmitJob submission, const Reply<SubmittedJob>& reply);
  void extend(ExtendJob extension, const Reply<SubmittedJob>& reply);
  void get(const JobId& id, const Reply<JobSnapshot>& reply);
  void list(const ListJobs& query, const Reply<JobPage>& reply);
  void cancel(const JobId& id, const Reply<JobSnapshot>& reply);
  void watch(const JobId& id, std::function<void()> wake,
             const Reply<std::unique_ptr<Subscription>>& reply, Seat seat);
  void status(const Reply<SchedulerStatus>& reply);

  // core_images.cpp
  void image(const JobId& id, const std::string& layer, const Reply<JobImagePtr>& reply);

  // core_scenes.cpp
  void replay_inputs(const JobId& id, const Reply<ReplayInputs>& reply);
  void add_scene(std::shared_ptr<std::unique_ptr<SceneUpload>> upload,
                 const AddSceneOptions& options, const Reply<AddedScene>& reply);
  void scene(const std::string& id, const Reply<SceneView>& reply);
  void scenes(std::size_t offset, std::size_t limit, const Reply<std::vector<SceneView>>& reply);
  void delete_scene(const std::string& id, const Reply<std::monostate>& reply);
  void prepare_scene(const std::string& id, const Reply<SceneView>& reply);

  // core_life.cpp
  void restore();
  void shutdown(std::chrono::milliseconds drain);  ///< not on the strand

 private:
  // core_jobs.cpp
  [[nodiscard]] Result<SubmittedJob> try_submit(SubmitJob submission);
  [[nodiscard]] Result<std::optional<SubmittedJob>> earlier_submission(const SubmitJob& submission);
  [[nodiscard]] Result<std::optional<SubmittedJob>> equal_result(const JobRequest& request);
  [[nodiscard]] Result<JobSnapshot> snapshot_of(const JobId& id);
  [[nodiscard]] Status check_resources(const JobRequest& request);
  void enqueue(LiveJob& job);

  // core_run.cpp
  void pump();
  void start_jobs();
  bool start_next_job();
  void start_preparing(LiveJob& job);
  void prepared(const JobId& id, Result<ReadyScene> scene);
  void start_rendering(LiveJob& job, ReadyScene scene);
  void canvas_ready(const JobId& id, const std::shared_ptr<Canvas>& canvas);
  void begin_rendering(LiveJob& job, Canvas& canvas);
  void look_for_missing_light(const LiveJob& of, const render::RenderSettings& settings,
                              std::shared_ptr<const render::PreparedScene> scene);
  void dispatch();
  void dispatch_one(LiveJob& job);
  void finished_task(TileOutcome outcome);
  void merge_outcome(LiveJob& job, const TileOutcome& outcome);
  void count_idle(LiveJob& job, const TileOutcome& outcome);
  void task_failed(LiveJob& job, const TileOutcome& outcome);

  // core_ending.cpp
  [[nodiscard]] bool is_large(const LiveJob& job) const;
  void begin_ending(LiveJob& job, JobEvent event, std::optional<Error> error);
  void archive_if_drained(LiveJob& job);
  void end_at_once(LiveJob& job);
  void archived(const JobId& id, const Status& saved, const std::shared_ptr<JobImage>& image,
                std::optional<PictureError> error);
  void picture_lost(const JobId& id, const Error& why);

  // core_extend.cpp
  [[nodiscard]] Result<SubmitJob> extended(ExtendJob extension);
  void go_on_from(LiveJob& job, KeptFilm kept);  ///< all but what is in the canvas
  void keep_film(LiveJob& job, const JobImage& image);

  // core_accuracy.cpp
  void begin_stops(LiveJob& job);
  void time_is_up(const JobId& id);
  void rest(LiveJob& job);
  void decided(LiveJob& job, Decision decision, double seconds, JobStatistics then);
  void place_samples(LiveJob& job, const std::vector<std::uint64_t>& samples);
  void finish(LiveJob& job, DoneBy by);
  void measure_if_due(LiveJob& job);
  void note_error(LiveJob& job, PictureError error, const JobStatistics& then);

  // core_publish.cpp
  void transition(LiveJob& job, JobEvent event, std::optional<Error> error = std::nullopt);
  void publish(LiveJob& job);
  void publish_soon(LiveJob& job);
  void refresh(LiveJob& job);
  void save(const LiveJob& job);
  void leave(LiveJob& job);
  void tell_queue_positions();

  // core_images.cpp
  [[nodiscard]] JobImagePtr resolve(LiveJob& job, bool layers);
  [[nodiscard]] std::shared_ptr<JobImage> last_picture_of(LiveJob& job);
  void image_when_stored(const JobId& id, const std::string& layer, const Reply<JobImagePtr>& reply);
  void remember(JobImagePtr image);
  [[nodiscard]] JobImagePtr remembered(const JobId& id, std::uint64_t revision, bool layers) const;
  void load_image(const JobSnapshot& job, const Reply<JobImagePtr>& reply);

  // core_layers.cpp
  void gather_layers(LiveJob& job, std::shared_ptr<JobImage> image, const Reply<JobImagePtr>& reply);
  void gather_strip(const std::shared_ptr<Gathering>& gathering);
  void gathered(const std::shared_ptr<Gathering>& gathering, bool whole);
  void not_gathered(const std::shared_ptr<Gathering>& gathering);

  // core_scenes.cpp
  [[nodiscard]] SceneView view(SceneRecord record) const;
  [[nodiscard]] Status begin_preparing(const std::string& id, const TreeBudget& budget);
  [[nodiscard]] std::optional<ReadyScene> scene_in_memory(const std::string& id, const TreeBudget& budget);
  void import_scene(std::shared_ptr<std::unique_ptr<SceneUpload>> upload,
                    const AddSceneOptions& options, const Reply<AddedScene>& reply);

  [[nodiscard]] LiveJob* find(const JobId& id);
  /// To give back the memory of a large film takes a tenth of a second: where it holds up nobody.
  template <typename Film>
  void let_go(Film held) {
    disk_.post([held = std::move(held)] {});
  }

  const Config config_;
  Parts parts_;
  EventHub hub_;
  std::map<JobId, std::unique_ptr<LiveJob>> live_;
  std::vector<JobId> queue_;  ///< in the order in which jobs start
  FairShare shares_;
  KeptFilms kept_;
  std::vector<JobImagePtr> images_;  ///< the most recent last
  /// By scene and budget, asked for by clients.
  std::map<std::pair<std::string, std::string>, Preparing> prepares_;
  std::map<int, SteadyTime> worker_free_since_;
  std::size_t active_ = 0;
  std::uint64_t active_film_bytes_ = 0;
  /// Tasks that an executor has: job and item. An answer for any other is late, or comes twice.
  std::set<std::pair<JobId, std::uint64_t>> in_flight_;
  std::size_t pending_imports_ = 0;
  std::uint64_t next_order_ = 1;
  double mean_job_seconds_ = 0.0;
  bool accepting_ = true;
  bool halted_ = false;  ///< nothing is merged or stored any more

  Gauge& queued_gauge_;
  Gauge& active_gauge_;
  Counter& rays_;
  Counter& non_finite_;
  Counter& tasks_;
  Counter& samples_;
  Counter& reused_;
  Histogram& task_seconds_;

  std::mutex idle_mutex_;
  std::condition_variable idle_;
  std::size_t busy_ = 0;  ///< guarded by idle_mutex_: active jobs + tasks in flight
  void note_busy();

  // Last: their threads use what is above. The disk's and the intake's threads post to the strand.
  std::shared_ptr<SerialThread> strand_;
  SerialThread disk_;
  SerialThread intake_;
};

}  // namespace raykiln::server
