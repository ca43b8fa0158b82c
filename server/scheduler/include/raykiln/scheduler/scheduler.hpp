// The one owner of all mutable job state: plans, films, retries, publication.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>

#include "raykiln/base/clock.hpp"
#include "raykiln/base/config.hpp"
#include "raykiln/base/log.hpp"
#include "raykiln/base/metrics.hpp"
#include "raykiln/base/reply.hpp"
#include "raykiln/base/result.hpp"
#include "raykiln/events/event_hub.hpp"
#include "raykiln/scheduler/views.hpp"
#include "raykiln/store/store.hpp"
#include "raykiln/workers/executor.hpp"
#include "raykiln/workers/scene_cache.hpp"
#include "raykiln/workers/scene_intake.hpp"

namespace raykiln::server {

/// Safe to use from any thread; no call blocks on anything but a short lock. Replies come on a thread of the
/// scheduler, never within the call itself; after shutdown() the answer is "shutting_down", given within the call.
///
/// Errors that calls answer with, besides those of store, intake and validation: job_not_found,
/// scene_not_found, invalid_request (`where` a JSON pointer, "/camera" too), invalid_parameter (cursor,
/// layer), film_too_large (kTooLarge), queue_full (kTooMany), idempotency_key_reused (kConflict),
/// job_finished (kConflict), scene_in_use (kConflict), digest_mismatch (kInvalid), too_many_uploads
/// (kTooMany), image_not_ready (kNotFound), too_many_streams (kUnavailable), shutting_down
/// (kUnavailable). A failed job's own error has the code of what went wrong, "render_failed" for
/// faults while rendering.
class Scheduler {
 public:
  struct Parts {
    Store& store;
    Executor& executor;
    SceneIntake& intake;
    SceneCache& cache;
    const Clock& clock;
    MetricsRegistry& metrics;
    Log log;
    int judged_at_once_px = 65'536;  ///< the error of larger films is judged off the strand, also where work waits for it
  };
  /// Reads the store: unfinished jobs are queued again. All parts must outlive the scheduler.
  Scheduler(const Config& config, Parts parts);
  ~Scheduler();  ///< shutdown(0 s)
  Scheduler(const Scheduler&) = delete;
  Scheduler& operator=(const Scheduler&) = delete;

  // Jobs.
  void submit(SubmitJob submission, Reply<SubmittedJob> reply);
  /// A new job that goes on from the samples of a completed one: the same picture as if its stop had been asked
  /// for at once. "job_not_completed" (kConflict); "invalid_request" when the job has as many samples already.
  void extend(ExtendJob extension, Reply<SubmittedJob> reply);
  void get(JobId id, Reply<JobSnapshot> reply);
  void list(ListJobs query, Reply<JobPage> reply);
  /// The snapshot just after; "job_finished" when it had ended in another way than cancelled.
  void cancel(JobId id, Reply<JobSnapshot> reply);
  /// See EventHub: `wake` must only post; take() of the subscription gives the newest snapshot, the
  /// first call the present one.
  void watch(JobId id, std::function<void()> wake, Reply<std::unique_ptr<Subscription>> reply,
             Seat seat = Seat::kClient);
  /// The newest picture, resolved once per revision. `layer`: "beauty" for the picture alone, "all" with its
  /// layers (which a picture stored by an older version lacks).
  void image(JobId id, std::string layer, Reply<JobImagePtr> reply);
  /// What the job is rendered with. While its scene is not in memory: "scene_not_ready"
  /// (kUnavailable), and preparing it has begun; "scene_not_found" when it was deleted; what the job
  /// failed with where that was "tree_too_large"; and once each time it goes wrong, why it cannot be prepared.
  void replay_inputs(JobId id, Reply<ReplayInputs> reply);

  // Scenes. Upload: store.begin_upload(), append() on the caller's thread, finish(), add_scene().
  /// Imports and validates, then commits; a known scene is answered at once.
  void add_scene(std::unique_ptr<SceneUpload> upload, AddSceneOptions options,
                 Reply<AddedScene> reply);
  void scene(std::string id, Reply<SceneView> reply);
  void scenes(std::size_t offset, std::size_t limit, Reply<std::vector<SceneView>> reply);
  void delete_scene(std::string id, Reply<std::monostate> reply);
  /// Starts to make scene and tree of the default budget ready, if they are not; answers at once with the state.
  void prepare_scene(std::string id, Reply<SceneView> reply);

  void status(Reply<SchedulerStatus> reply);

  /// Blocks: admits nothing more, starts no queued job, lets active jobs work on until `drain` has
  /// passed, then stops what is in flight and saves. What has not ended runs again at the next start.
  void shutdown(std::chrono::milliseconds drain);

 private:
  class Core;
  std::unique_ptr<Core> core_;
};

}  // namespace raykiln::server
