#include <chrono>
#include <cstdlib>
#include <fstream>
#include <iostream>

#include "../one_line.hpp"
#include "../output_file.hpp"
#include "../scratch.hpp"
#include "batch_run.hpp"
#include "raykiln/image/encode.hpp"

namespace raykiln::server {
namespace {

bool write(const std::filesystem::path& path, const std::string& text) {
  if (path.empty()) return true;
  const auto error = write_whole_file(path, text);
  if (error) std::cerr << "raykiln: " << *error << '\n';
  return !error;
}

/// GitHub runs the step: say what it shows beside the code and on the page of the run.
void tell_github(const BatchResult& result) {
  if (std::getenv("GITHUB_ACTIONS") == nullptr) return;
  std::cout << github_annotations(result);
  const char* summary_file = std::getenv("GITHUB_STEP_SUMMARY");
  if (summary_file == nullptr) return;
  std::ofstream out(summary_file, std::ios::app | std::ios::binary);
  out << step_summary(result);
  if (!out.flush()) std::cerr << "raykiln: the step summary cannot be written\n";
}

bool write_reports(const CliOptions& options, const BatchResult& result, const std::filesystem::path& folder) {
  const BatchOptions& wanted = options.batch;
  const std::string json = batch_json(result) + '\n';
  bool written = write(wanted.junit, junit_xml(result)) && write(wanted.json, json);
  if (!wanted.html.empty()) {
    written = written && write(folder / "index.html", batch_html(result, folder)) && write(folder / "results.json", json);
  }
  if (options.json) std::cout << json;
  tell_github(result);
  return written;
}

ExitCode complain(const std::filesystem::path& file, const Error& error) {
  std::cerr << "raykiln: " << one_line(file.string() + ": " + error.message + (error.where.empty() ? "" : " (" + error.where + ')'))
            << '\n';
  return error.kind == ErrorKind::kInvalid ? ExitCode::kUsage : ExitCode::kScene;
}

}  // namespace

ExitCode batch_command(const CliOptions& options) {
  render::set_image_library_threads(1);
  const BatchOptions& wanted = options.batch;
  const auto plan = read_batch_file(wanted.file, JobLimits{});
  if (!plan) return complain(wanted.file, plan.error());
  const Scratch scratch;
  const auto folder = wanted.html.empty() ? scratch.path() : wanted.html;
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    std::cerr << "raykiln: " << folder.string() << ": " << error.message() << '\n';
    return ExitCode::kFailure;
  }
  BatchResult result{.plan = *plan, .pictures = std::vector<PictureResult>(plan->pictures.size()), .batch = {}, .server = {}};
  const auto begun = std::chrono::steady_clock::now();
  const BatchRun run{.options = options, .folder = folder, .threads = options.threads, .quiet = options.quiet};
  bool waited = true;
  const ExitCode ran = wanted.local ? run_batch_here(run, result) : run_batch_on_server(run, result, waited);
  if (ran != ExitCode::kOk || !waited) return ran;
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  if (!write_reports(options, result, folder)) return ExitCode::kFailure;
  if (!options.quiet) std::cerr << summary(result) << '\n';
  return outcome(result);
}

}  // namespace raykiln::server
