// All that can be said about a job at one revision: an immutable value.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "raykiln/base/clock.hpp"
#include "raykiln/base/result.hpp"
#include "raykiln/jobs/effect_report.hpp"
#include "raykiln/jobs/forecast.hpp"
#include "raykiln/jobs/job_request.hpp"
#include "raykiln/jobs/job_state.hpp"
#include "raykiln/jobs/picture_error.hpp"

namespace raykiln::server {

using JobId = std::string;

enum class PrepareStage { kNone, kWaiting, kImporting, kBuilding };
[[nodiscard]] std::string_view name(PrepareStage stage);  ///< "", "waiting", "importing", "building"

struct PrepareProgress {
  PrepareStage stage = PrepareStage::kNone;
  double fraction = 0.0;  ///< of the stage, [0, 1]
};

struct RenderProgress {
  std::uint64_t samples_done = 0;    ///< over all pixels
  std::uint64_t samples_target = 0;  ///< over all pixels
  double samples_per_pixel = 0.0;    ///< mean so far
  int tiles = 0;                     ///< of the film
  int tiles_started = 0;             ///< with at least one sample in every pixel
  int tiles_done = 0;                ///< with all samples
  double stop_fraction = 0.0;        ///< of the way to a stop by seconds or error; 1 when it has come
  [[nodiscard]] double fraction() const {
    return samples_target == 0
               ? 0.0
               : std::max(stop_fraction,
                          static_cast<double>(samples_done) / static_cast<double>(samples_target));
  }
};

/// What was accepted but not taken as it stands.
struct JobWarning {
  std::string code;  ///< snake_case
  std::string message;
  std::string where;
};

/// A sample whose value was not finite, to be replayed exactly.
struct LocatedSample {
  int x = 0, y = 0;
  std::uint64_t sample = 0;
};

/// What the tree of a scene came to.
struct TreeFigures {
  std::uint64_t references = 0;     ///< triangles of leaves; one may stand in several
  std::uint64_t bytes = 0;
  std::uint64_t peak_bytes = 0;     ///< most that the build held at once, beside the mesh
  bool budget_reached = false;      ///< a bound on references or bytes stopped a useful split
};

struct JobStatistics {
  double prepare_seconds = 0.0;  ///< waiting for scene and tree
  std::optional<double> tree_build_seconds{};  ///< 0: the tree was there already
  std::optional<TreeFigures> tree{};           ///< of the scene's tree, once it is there
  double render_seconds = 0.0;   ///< from the first task to the last sample (or until now)
  double worker_seconds = 0.0;   ///< spent rendering, summed over workers
  double idle_seconds = 0.0;     ///< of workers while this job had work to do
  double merge_seconds = 0.0;
  double publish_seconds = 0.0;  ///< snapshots, resolving and storing pictures
  double accuracy_seconds = 0.0;  ///< judging the error of the picture while it is rendered
  std::uint64_t tasks = 0, retried_tasks = 0;
  std::uint64_t paths = 0;
  std::uint64_t camera_rays = 0, bounce_rays = 0, shadow_rays = 0;
  std::uint64_t non_finite = 0, negative = 0;
  std::uint64_t truncated = 0;       ///< paths cut at the limit while they could go on
  std::uint64_t roulette_ends = 0;   ///< paths that roulette ended
  std::uint64_t lights_at_hits = 0;  ///< point lights at distance 0 from what they should light
  std::uint64_t stream_calls = 0;    ///< calls into the tree for closest hits
  std::uint64_t short_stream_calls = 0;  ///< of those, with fewer than 1024 rays while as many paths lived
  double traversal_seconds = 0.0, shading_seconds = 0.0;  ///< parts of worker_seconds
  std::vector<LocatedSample> bad_samples;  ///< at most 16
  std::uint64_t film_bytes = 0;

  [[nodiscard]] std::uint64_t rays() const { return camera_rays + bounce_rays + shadow_rays; }
  /// Rays a second of wall time while rendering.
  [[nodiscard]] double rays_per_second() const {
    return render_seconds > 0.0 ? static_cast<double>(rays()) / render_seconds : 0.0;
  }
  /// (idle + merge + publish + accuracy) / worker time.
  [[nodiscard]] double overhead_fraction() const {
    return worker_seconds > 0.0
               ? (idle_seconds + merge_seconds + publish_seconds + accuracy_seconds) / worker_seconds
               : 0.0;
  }
};

struct JobSnapshot {
  JobId id;
  JobRequest request;
  JobState state = JobState::kQueued;
  std::uint64_t revision = 1;  ///< rises by one with every change
  /// Revision at which the picture last changed; 0: there is none yet.
  std::uint64_t image_revision = 0;
  WallTime created{};
  std::optional<WallTime> started{};   ///< left the queue
  std::optional<WallTime> finished{};  ///< reached a final state
  std::optional<std::size_t> queue_position{};  ///< 0: next; while queued
  PrepareProgress prepare;
  RenderProgress progress;
  double elapsed_seconds = 0.0;                 ///< since it left the queue
  std::optional<double> remaining_seconds{};    ///< estimate; while rendering
  JobStatistics statistics;
  std::optional<PictureError> accuracy{};      ///< as last judged; nothing before
  DoneBy done_by = DoneBy::kNone;              ///< what ended it; completed jobs
  std::vector<CurvePoint> curve;               ///< error against time; at most kMostCurvePoints
  std::vector<Forecast> forecasts;             ///< of the time to half the error; at most kMostForecasts
  std::vector<std::uint64_t> tile_samples;     ///< where tiles differ in the end; else empty
  JobId continues{};                           ///< the job whose samples it goes on from; empty: none
  double continued_samples = 0.0;              ///< a pixel, taken over from it; 0: it began anew
  EffectReport effects;                        ///< from the moment when the scene is known
  std::vector<JobWarning> warnings;            ///< of the scene, and of this job
  std::optional<Error> error{};                 ///< when failed
};

/// What the store keeps. decode_job gives nothing for text that is no record of a job.
[[nodiscard]] std::string encode_job(const JobSnapshot& job);
[[nodiscard]] std::optional<JobSnapshot> decode_job(std::string_view text);

}  // namespace raykiln::server
