// Progress of a batch: bars on a terminal, a line a picture elsewhere.
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "raykiln/app/progress.hpp"

namespace raykiln::server {

inline constexpr std::size_t kMostBatchBars = 8;

struct RunningPicture {
  std::string name;
  ProgressState state;
};

/// No colours anywhere, so that NO_COLOR has nothing to switch off.
class BatchProgress {
 public:
  BatchProgress(std::ostream& out, bool terminal, bool quiet) : out_(out), terminal_(terminal), quiet_(quiet) {}

  /// Terminal: redraws one bar for each of the first kMostBatchBars running pictures and one for all.
  void show(std::size_t done, std::size_t total, const std::vector<RunningPicture>& running);
  /// A picture has ended; `line` says how.
  void ended(const std::string& name, const std::string& line);
  void finish();

 private:
  void clear();
  std::ostream& out_;
  bool terminal_, quiet_;
  std::size_t lines_ = 0;  ///< drawn, to be drawn over
};

}  // namespace raykiln::server
