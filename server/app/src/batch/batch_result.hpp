// What became of a batch, picture by picture.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "batch_plan.hpp"
#include "raykiln/app/comparison.hpp"
#include "raykiln/app/exit_code.hpp"

namespace raykiln::server {

enum class PictureState : std::uint8_t { kWaiting, kCompleted, kFailed, kCancelled, kSkipped };
[[nodiscard]] const char* name(PictureState state);

struct PictureResult {
  PictureState state = PictureState::kWaiting;
  std::string failure;       ///< why it failed, "code: text (where)"
  std::string job;           ///< empty without a daemon
  std::string scene;         ///< its digest
  bool reused = false;       ///< the stored result of an equal request
  double seconds = 0.0;      ///< of rendering; 0 when reused
  double samples = 0.0;      ///< a pixel
  std::optional<double> error_reached;  ///< relative, from the picture's own error layer
  bool limit_reached = false;           ///< the job ended by a limit before its error target
  std::optional<Comparison> comparison; ///< nothing without a reference; its PNGs lie in files
  bool reference_missing = false;       ///< named, but there is no such file
};

/// Of one picture. Differing from the reference is an outcome, not a failure of the render.
[[nodiscard]] ExitCode outcome(const PictureResult& result);

struct BatchResult {
  const BatchPlan& plan;
  std::vector<PictureResult> pictures;  ///< as in the plan
  std::string batch;                    ///< id on the server; empty without one
  std::string server;                   ///< URL; empty without one
  double seconds = 0.0;                 ///< from the start to the last picture
  bool wait_ended = false;              ///< before the batch, which goes on

  [[nodiscard]] std::size_t count(PictureState state) const;
  [[nodiscard]] std::size_t differing() const;
  [[nodiscard]] std::size_t reused() const;
};

/// kWaitEnded where the wait did; else the gravest: failed, then cancelled, then differs, then limit reached, then done.
[[nodiscard]] ExitCode outcome(const BatchResult& result);

/// One line: "6 pictures: 5 completed (2 reused), 1 failed; 1 differs from its reference".
[[nodiscard]] std::string summary(const BatchResult& result);
/// One line of a picture: what failed or differs, or that all is well.
[[nodiscard]] std::string verdict_line(const PictureResult& result);

/// Where the files of a picture are, below the report's folder.
[[nodiscard]] std::filesystem::path picture_file(const std::string& picture, const std::string& ending);

/// JUnit XML: one testcase a picture.
[[nodiscard]] std::string junit_xml(const BatchResult& result);
/// Schema proto/batch-report.schema.json.
[[nodiscard]] std::string batch_json(const BatchResult& result);
/// One page with all pictures in it; reads them from `folder`.
[[nodiscard]] std::string batch_html(const BatchResult& result, const std::filesystem::path& folder);
/// Markdown of at most 900 KiB: what GitHub shows beside a run.
[[nodiscard]] std::string step_summary(const BatchResult& result);
/// GitHub workflow commands: at most 10 errors.
[[nodiscard]] std::string github_annotations(const BatchResult& result);

}  // namespace raykiln::server
