#include <unistd.h>

#include <chrono>
#include <iostream>

#include "../load_here.hpp"
#include "../output_file.hpp"
#include "accuracy_report.hpp"
#include "raykiln/app/cli.hpp"
#include "raykiln/app/progress.hpp"
#include "raykiln/scheduler/render_inputs.hpp"
#include "raykiln/workers/local_pool.hpp"

namespace raykiln::server {
namespace {

ExitCode complain(const Error& error) {
  std::cerr << "raykiln: " << error.message << " [" << error.code << "]\n";
  return error.code == "invalid_request" ? ExitCode::kUsage : ExitCode::kScene;
}

std::optional<std::string> write(const std::filesystem::path& path, const std::string& text) {
  return path.empty() ? std::nullopt : write_whole_file(path, text);
}

render::Study study_of(const std::shared_ptr<const render::Scene>& scene, const render::RenderSettings& view,
                       const CliOptions& options) {
  WorkerSettings workers;
  workers.threads = options.threads;
  LocalPool pool(workers);
  const auto runner = pool.task_runner({}, {});
  const auto begun = std::chrono::steady_clock::now();
  ProgressLine line(std::cerr, isatty(STDERR_FILENO) != 0, options.quiet);
  return render::measure_knobs(scene, render::knob_variants(view, *scene),
                               {options.accuracy.seconds, options.accuracy.reference_seconds}, *runner,
                               [&](const std::string& stage, double fraction) {
                                 const std::chrono::duration<double> since = std::chrono::steady_clock::now() - begun;
                                 line.show({.stage = stage, .fraction = fraction, .elapsed_seconds = since.count()});
                               });
}

}  // namespace

ExitCode accuracy_command(const CliOptions& options) {
  const JobRequest& request = options.picture.request;
  const auto pixels = std::uint64_t{1} * static_cast<std::uint64_t>(request.width) * static_cast<std::uint64_t>(request.height);
  if (pixels > render::kMostStudyPixels) {
    std::cerr << "raykiln: --size: at most " << render::kMostStudyPixels << " pixels, such as 256x256\n";
    return ExitCode::kUsage;
  }
  const auto loaded = load_here(options.scene, options.allow_missing);
  if (!loaded) return complain(loaded.error());
  const auto view = render_settings(request, *loaded->scene);
  if (!view) return complain(view.error());

  const AccuracyReport report =
      accuracy_report(options.scene.filename().string(), study_of(loaded->scene, *view, options));
  std::cout << (options.json ? accuracy_json(report) : accuracy_text(report));
  for (const auto& fault : {write(options.accuracy.html, accuracy_html(report)),
                            write(options.accuracy.csv, accuracy_csv(report))}) {
    if (!fault) continue;
    std::cerr << "raykiln: " << *fault << '\n';
    return ExitCode::kFailure;
  }
  return report.study.reference.exact_enough() ? ExitCode::kOk : ExitCode::kLimitReached;
}

}  // namespace raykiln::server
