// Progress for people: one line that is redrawn on a terminal, plain lines elsewhere.
#pragma once

#include <chrono>
#include <optional>
#include <ostream>
#include <string>

namespace raykiln::server {

struct ProgressState {
  std::string stage;      ///< "queued", "building", "rendering", ...
  double fraction = 0.0;  ///< of the stage
  double samples_done = 0.0, samples_target = 0.0;
  double elapsed_seconds = 0.0;
  std::optional<double> remaining_seconds{};
  double rays_per_second = 0.0;
};

/// "rendering [#####.....]  42 %  26.9/64 samples  3.1 s, 4.2 s left  2.1 Mrays/s"
[[nodiscard]] std::string progress_text(const ProgressState& state, int bar_width);

class ProgressLine {
 public:
  /// Off a terminal a line is written when the stage changes and for every tenth of it.
  ProgressLine(std::ostream& out, bool terminal, bool quiet);
  ~ProgressLine();  ///< finish()
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void show(const ProgressState& state);
  /// Ends the redrawn line, so that other text can follow.
  void finish();

 private:
  std::ostream& out_;
  bool terminal_, quiet_;
  bool open_ = false;  ///< the cursor stands behind a redrawn line
  std::string last_stage_;
  int last_tenth_ = -1;
};

}  // namespace raykiln::server
