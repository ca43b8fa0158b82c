// The command line program: its options, and one function per command.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "raykiln/app/comparison.hpp"
#include "raykiln/app/exit_code.hpp"
#include "raykiln/jobs/job_request.hpp"

namespace raykiln::server {

/// What a picture is to be like; shared by `render` and `submit`.
struct PictureOptions {
  JobRequest request;  ///< without the scene
  std::string camera;  ///< name or index; empty: the first
  std::vector<int> crop;  ///< x, y, width and height in pixels; empty: all of it
  double exposure_stops = 0.0;
  bool half = false;  ///< EXR in half floats
};

/// Which sample `replay` renders again.
struct ReplayPlace {
  int x = 0, y = 0;  ///< pixel, from the top left corner
  std::uint64_t sample = 0;
};

/// What `compare` reads and writes.
struct CompareOptions {
  std::filesystem::path render, reference;
  std::filesystem::path difference, z_map;  ///< PNG files to write; empty: none
  ComparisonSettings settings;
};

/// What `batch` runs and writes.
struct BatchOptions {
  std::filesystem::path file;
  std::filesystem::path junit, json;  ///< files to write; empty: none
  std::filesystem::path html;         ///< folder of the report; empty: none
  bool local = false;                 ///< in this process
  bool no_reuse = false;              ///< render what was rendered before
  std::string resume;                 ///< id of a batch that was sent before; empty: a new one
  bool rerun = false;                 ///< of `resume`: what failed
  bool cancel_on_interrupt = false;
  double timeout_seconds = 0.0;       ///< of waiting; 0: none
};

/// What `approve` makes references of.
struct ApproveOptions {
  std::filesystem::path report;       ///< folder that `batch --html` wrote
  std::vector<std::string> pictures;  ///< by name
  bool all = false;                   ///< every picture that differs or has no reference yet
};

/// What `accuracy` spends and writes.
struct AccuracyOptions {
  double seconds = 1.0, reference_seconds = 300.0;  ///< of one processor
  std::filesystem::path html, csv;                  ///< files to write; empty: none
};

struct CliOptions {
  std::string command;
  std::string server = "http://127.0.0.1:8080";
  bool json = false;
  bool quiet = false;
  std::filesystem::path scene;
  bool allow_missing = false;  ///< textures
  std::vector<std::filesystem::path> outputs;
  PictureOptions picture;
  ReplayPlace replay;
  CompareOptions compare;
  BatchOptions batch;
  ApproveOptions approve;
  AccuracyOptions accuracy;
  int threads = 0;
  bool wait = false;
  std::string job;
  std::string state;  ///< filter of `jobs`
  std::string idempotency_key;
  double pilot_seconds = 2.0;  ///< of `quote`
};

struct ParsedCli {
  CliOptions options;
  int exit_code = -1;  ///< -1: run
};
[[nodiscard]] ParsedCli parse_cli_options(int argc, const char* const* argv);

[[nodiscard]] ExitCode run_cli(const CliOptions& options);

/// Renders without a daemon.
[[nodiscard]] ExitCode render_command(const CliOptions& options);

/// Runs the checks of renderer/selftest, a line each. kCheckFailed when one fails.
[[nodiscard]] ExitCode selftest_command(const CliOptions& options);

/// Reports what is questionable about a scene. kCheckFailed when a finding is an error.
[[nodiscard]] ExitCode lint_command(const CliOptions& options);

/// Lists the effects that a scene calls for with these settings, and what is left out.
[[nodiscard]] ExitCode effects_command(const CliOptions& options);

/// Measures what the knobs of the renderer cost on a scene: error against seconds, and bias. kLimitReached when
/// the reference was not ten times as exact as what it judges.
[[nodiscard]] ExitCode accuracy_command(const CliOptions& options);

/// Renders one sample of one pixel again and prints its radiance, finite or not: of a scene, here, or
/// of a job, on its server, where SCENE is the id of a job and no such file is there.
[[nodiscard]] ExitCode replay_command(const CliOptions& options);

/// Judges a render by its reference. kImageDiffers when the noise of both does not explain the difference.
[[nodiscard]] ExitCode compare_command(const CliOptions& options);

/// Renders and judges all pictures of a batch file, and writes the reports.
[[nodiscard]] ExitCode batch_command(const CliOptions& options);

/// Makes pictures of a report the references of the next batch.
[[nodiscard]] ExitCode approve_command(const CliOptions& options);

[[nodiscard]] ExitCode submit_command(const CliOptions& options);
/// More samples for a completed job, from those that it has.
[[nodiscard]] ExitCode extend_command(const CliOptions& options);
/// Renders for a short time and prints what less error costs.
[[nodiscard]] ExitCode quote_command(const CliOptions& options);
[[nodiscard]] ExitCode watch_command(const CliOptions& options);
[[nodiscard]] ExitCode fetch_command(const CliOptions& options);
[[nodiscard]] ExitCode cancel_command(const CliOptions& options);
[[nodiscard]] ExitCode scenes_command(const CliOptions& options);
[[nodiscard]] ExitCode jobs_command(const CliOptions& options);
[[nodiscard]] ExitCode health_command(const CliOptions& options);

}  // namespace raykiln::server
