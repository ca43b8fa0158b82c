#include "batch_progress.hpp"

#include <algorithm>

#include "../one_line.hpp"

namespace raykiln::server {
namespace {

std::string bar(double fraction) {
  constexpr std::size_t kWidth = 24;
  const auto full = static_cast<std::size_t>(std::clamp(fraction, 0.0, 1.0) * static_cast<double>(kWidth));
  return std::string("[").append(full, '#').append(kWidth - full, '.').append("]");
}

}  // namespace

void BatchProgress::clear() {
  for (; lines_ > 0; --lines_) out_ << "\x1b[1A\x1b[2K";
  out_ << '\r';
}

void BatchProgress::show(std::size_t done, std::size_t total, const std::vector<RunningPicture>& running) {
  if (quiet_ || !terminal_) return;
  clear();
  double whole = static_cast<double>(done);
  for (const RunningPicture& picture : running) {
    whole += std::clamp(picture.state.fraction, 0.0, 1.0);
    if (lines_ >= kMostBatchBars) continue;
    out_ << picture.name.substr(0, 24) << ' ' << progress_text(picture.state, 24) << '\n';
    ++lines_;
  }
  out_ << "all " << bar(total > 0 ? whole / static_cast<double>(total) : 1.0) << ' ' << done << '/' << total << '\n';
  ++lines_;
  out_.flush();
}

void BatchProgress::ended(const std::string& name, const std::string& line) {
  if (quiet_) return;
  if (terminal_) clear();
  out_ << name << ": " << one_line(line) << std::endl;
}

void BatchProgress::finish() {
  if (terminal_ && !quiet_) clear();
  out_.flush();
}

}  // namespace raykiln::server
