// A batch in this process: one picture after another, each on all processors.
#include <unistd.h>

#include <iostream>
#include <new>

#include "batch_judge.hpp"
#include "batch_progress.hpp"
#include "batch_run.hpp"
#include "raykiln/app/progress.hpp"
#include "raykiln/app/local_render.hpp"
#include "raykiln/app/scene_package.hpp"
#include "raykiln/jobs/picture_error.hpp"

namespace raykiln::server {
namespace {

Result<std::vector<std::uint8_t>> try_render(const PlannedPicture& planned, LocalPool& pool, PictureResult& result,
                                             const std::function<void(const ProgressState&)>& progress) {
  const auto package = find_scene_files(planned.scene);
  if (!package) return package.error();
  const auto scene = scene_id(*package);
  if (!scene) return scene.error();
  result.scene = *scene;
  JobRequest request = planned.request;
  request.scene = *scene;
  auto picture = render_locally(*package, request, pool, progress);
  if (!picture) return picture.error();
  result.seconds = picture->job.statistics.render_seconds;
  result.samples = picture->job.progress.samples_per_pixel;
  const auto& accuracy = picture->job.accuracy;
  if (accuracy && accuracy->known()) result.error_reached = accuracy->error.value;
  result.limit_reached = request.stop.error && !(accuracy && target_met(request.stop, *accuracy));
  return local_exr(*picture, *scene);
}

/// The EXR of a picture, or why there is none. One that is too large fails alone.
Result<std::vector<std::uint8_t>> render_one(const PlannedPicture& planned, LocalPool& pool, PictureResult& result,
                                             const std::function<void(const ProgressState&)>& progress) {
  try {
    return try_render(planned, pool, result, progress);
  } catch (const std::bad_alloc&) {
    return Error{ErrorKind::kInternal, "internal", "out of memory", planned.name};
  }
}

}  // namespace

ExitCode run_batch_here(const BatchRun& run, BatchResult& result) {
  WorkerSettings workers;
  workers.threads = run.threads;
  LocalPool pool(workers);
  BatchProgress progress(std::cerr, isatty(STDERR_FILENO) != 0, run.quiet);
  const std::size_t total = result.pictures.size();
  bool stop = false;
  for (std::size_t i = 0; i < total; ++i) {
    const PlannedPicture& planned = result.plan.pictures[i];
    PictureResult& own = result.pictures[i];
    if (stop) {
      own.state = PictureState::kSkipped;
      continue;
    }
    const auto exr = render_one(planned, pool, own, [&](const ProgressState& state) {
      progress.show(i, total, {{planned.name, state}});
    });
    own.state = exr ? PictureState::kCompleted : PictureState::kFailed;
    if (!exr) {
      own.failure = failure_text(exr.error());
    } else if (const auto judged = judge_render(result.plan, planned, *exr, run.folder, own); !judged) {
      progress.finish();
      std::cerr << "raykiln: " << judged.error().message << '\n';
      return ExitCode::kFailure;
    }
    progress.ended(planned.name, verdict_line(own));
    stop = result.plan.fail_fast && outcome(own) != ExitCode::kOk;
  }
  progress.finish();
  return ExitCode::kOk;
}

}  // namespace raykiln::server
