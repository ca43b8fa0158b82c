#include "accuracy_line.hpp"

#include <cstdio>
#include <optional>

#include "raykiln/jobs/picture_error.hpp"

namespace raykiln::server {
namespace {

std::string percent(double fraction) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g %%", 100.0 * fraction);
  return text;
}

/// Why a target was missed, by what stopped the job before it.
std::string missed(double target, DoneBy done_by) {
  std::string text = "; target of " + percent(target) + " not reached";
  if (done_by == DoneBy::kSamples) text += ": allow more samples (--samples)";
  if (done_by == DoneBy::kSeconds) text += ": allow more time (--seconds)";
  return text;
}

/// A job's ending: `met` says whether its target was.
std::string line_of(const PictureError& a, DoneBy done_by, const std::optional<double>& target, bool met) {
  std::string line = "error " + (a.known() ? percent(a.error.value) + " (95 %: " + percent(a.error.low) + " to " +
                                                 percent(a.error.high) + ')'
                                           : std::string("unknown"));
  char samples[32];
  std::snprintf(samples, sizeof samples, "%.4g", a.mean_samples);
  line += std::string(" after ") + samples + " samples";
  if (done_by != DoneBy::kNone) line += ", stopped by " + std::string(name(done_by));
  if (target && !met) line += missed(*target, done_by);
  for (const std::string& notice : a.notices) {
    line += "; " + remark(notice);
    if (wants_more_samples(notice)) line += " (--samples, --seconds)";
  }
  return line;
}

}  // namespace

std::string accuracy_line(const JobSnapshot& job) {
  if (!job.accuracy) return {};
  const StopRule& stop = job.request.stop;
  return line_of(*job.accuracy, job.done_by, stop.error, target_met(stop, *job.accuracy));
}

std::string accuracy_line(const JobView& job) {
  if (!job.accuracy) return {};
  return line_of(*job.accuracy, job.done_by, job.target, job.target_reached);
}

}  // namespace raykiln::server
