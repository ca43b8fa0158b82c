// What the scheduler tells about scenes and pictures.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "raykiln/jobs/job_snapshot.hpp"
#include "raykiln/render/render.hpp"
#include "raykiln/store/store.hpp"
#include "raykiln/workers/scene_cache.hpp"
#include "raykiln/workers/scene_report.hpp"

namespace raykiln::server {

struct SceneView {
  SceneRecord record;
  SceneReport report;  ///< decoded from the record
  CacheState cache = CacheState::kAbsent;  ///< with the tree of the default budget, as prepare_scene() makes it
  PrepareProgress prepare;             ///< while kBuilding
  std::optional<TreeReport> tree{};    ///< nothing before the build
};

struct AddedScene {
  SceneView scene;
  bool created = false;  ///< false: it was known already
};

struct AddSceneOptions {
  std::string name;             ///< free text; may be empty
  std::string expected_digest;  ///< empty, or what the id must come out as ("digest_mismatch")
  bool allow_missing = false;   ///< missing textures are left out with a warning
};

struct SubmitJob {
  JobRequest request;
  std::string idempotency_key;  ///< empty: none; at most 200 bytes
  JobId continues{};            ///< a completed job whose samples are taken over; empty: none
};

/// More of a completed job: its request with another stop, which counts from the job's beginning.
struct ExtendJob {
  JobId job;
  StopRule stop;
  std::optional<int> priority{};  ///< nothing: the job's
  std::string idempotency_key;
};

struct SubmittedJob {
  JobSnapshot job;
  bool created = false;  ///< false: the key was used before for an equal request, or reused
  bool reused = false;   ///< a job that had completed before, with the picture that was asked for
};

struct ListJobs {
  std::vector<JobState> states{};  ///< empty: any
  std::string scene{};    ///< empty: any
  std::string cursor{};   ///< of the page before; empty: the newest
  std::size_t limit = 50; ///< 1 .. 500
};

struct JobPage {
  std::vector<JobSnapshot> jobs;  ///< newest first
  std::string next_cursor;        ///< empty: no more
};

/// A job's picture at one revision: immutable, to be encoded by whoever asked, at any exposure.
struct JobImage {
  JobId job;
  std::uint64_t revision = 0;  ///< the job's revision at which this picture came to be
  bool is_final = false;       ///< the job has ended: it will not change any more
  render::Image image;         ///< linear RGB
  /// Standard errors (3 a pixel; NaN: unknown), samples and worker seconds (1 a pixel each). Empty where only
  /// the picture was asked for, or was stored.
  std::vector<float> error, samples, seconds;
  std::vector<StoredLayer> layers;  ///< those that the job asks for; empty like these
  std::string scene;           ///< scene id
  JobRequest request;
  EffectReport effects;        ///< of the job
  double samples_per_pixel = 0.0;
  double render_seconds = 0.0;
};
using JobImagePtr = std::shared_ptr<const JobImage>;

/// What a sample of a job is rendered again with; holds scene and tree while it lives.
struct ReplayInputs {
  std::shared_ptr<const render::PreparedScene> scene;
  render::RenderSettings settings;
  EffectReport effects;
};

struct SchedulerStatus {
  bool accepting = true;
  std::size_t queued = 0, active = 0, watchers = 0;
};

}  // namespace raykiln::server
