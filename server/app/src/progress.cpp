#include "raykiln/app/progress.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace raykiln::server {
namespace {

template <class... Values>
std::string print(const char* format, Values... values) {
  std::array<char, 128> text{};
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

std::string duration(double seconds) {
  if (seconds < 100.0) return print("%.1f s", seconds);
  const auto whole = std::lround(seconds);
  if (whole < 3600) return print("%ld:%02ld min", whole / 60, whole % 60);
  return print("%ld:%02ld h", whole / 3600, whole / 60 % 60);
}

}  // namespace

std::string progress_text(const ProgressState& state, int bar_width) {
  const double fraction = std::clamp(state.fraction, 0.0, 1.0);
  std::string text = state.stage;
  if (bar_width > 0) {
    const auto full = static_cast<std::size_t>(fraction * bar_width);
    text += " [" + std::string(full, '#') +
            std::string(static_cast<std::size_t>(bar_width) - full, '.') + ']';
  }
  text += print(" %3.0f %%", std::floor(fraction * 100.0));
  if (state.samples_target > 0.0) {
    text += print("  %.4g/%.0f samples", state.samples_done, state.samples_target);
  }
  text += "  " + duration(state.elapsed_seconds);
  if (state.remaining_seconds) text += ", " + duration(*state.remaining_seconds) + " left";
  if (state.rays_per_second > 0.0) text += print("  %.2f Mrays/s", state.rays_per_second / 1e6);
  return text;
}

ProgressLine::ProgressLine(std::ostream& out, bool terminal, bool quiet)
    : out_(out), terminal_(terminal), quiet_(quiet) {}

ProgressLine::~ProgressLine() { finish(); }

void ProgressLine::show(const ProgressState& state) {
  if (quiet_) return;
  if (terminal_) {
    out_ << "\r\x1b[K" << progress_text(state, 24) << std::flush;
    open_ = true;
    return;
  }
  const int tenth = static_cast<int>(std::clamp(state.fraction, 0.0, 1.0) * 10.0);
  if (state.stage == last_stage_ && tenth <= last_tenth_) return;
  last_stage_ = state.stage;
  last_tenth_ = tenth;
  out_ << progress_text(state, 0) << std::endl;
}

void ProgressLine::finish() {
  if (open_) out_ << std::endl;
  open_ = false;
}

}  // namespace raykiln::server
