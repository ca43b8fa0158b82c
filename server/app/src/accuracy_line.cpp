#include "accuracy_line.hpp"

#include <cstdio>
#include <string_view>
#include <utility>

#include "raykiln/jobs/picture_error.hpp"

namespace raykiln::server {
namespace {

std::string percent(double fraction) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g %%", 100.0 * fraction);
  return text;
}

/// What to mind, by the names of the contract (Accuracy.notices).
constexpr std::pair<std::string_view, std::string_view> kNotices[] = {
    {"unsampled_pixels", "some pixels have no sample: allow more (--samples, --seconds)"},
    {"error_unknown", "too few samples to judge: allow 64 a pixel or more (--samples, --seconds)"},
    {"error_rough", "fewer than 64 samples in a pixel, so the interval may be too narrow: allow more (--samples, --seconds)"},
    {"error_sampled", "judged on a part of the pixels"},
    {"heavy_tailed", "rare bright samples make up much of the noise, so the error may be larger: allow more samples"},
    {"no_variance", "no two samples differ: there is no noise, or light that no sample has found"},
    {"aliasing_not_measured", "samples lie in the middle of their pixels, and aliasing is not measured"},
    {"adaptive", "samples were placed where the error was, for which a small bias is possible"},
};

std::string in_words(const std::string& notice) {
  for (const auto& [name, words] : kNotices) {
    if (notice == name) return std::string(words);
  }
  return notice;
}

/// Why a target was missed, by what stopped the job before it.
std::string missed(const JobSnapshot& job) {
  std::string text = "; target of " + percent(*job.request.stop.error) + " not reached";
  if (job.done_by == DoneBy::kSamples) text += ": allow more samples (--samples)";
  if (job.done_by == DoneBy::kSeconds) text += ": allow more time (--seconds)";
  return text;
}

}  // namespace

std::string accuracy_line(const JobSnapshot& job) {
  if (!job.accuracy) return {};
  const PictureError& a = *job.accuracy;
  std::string line = "error " + (a.known() ? percent(a.error.value) + " (95 %: " + percent(a.error.low) + " to " +
                                                 percent(a.error.high) + ')'
                                           : std::string("unknown"));
  char samples[32];
  std::snprintf(samples, sizeof samples, "%.4g", a.mean_samples);
  line += std::string(" after ") + samples + " samples, stopped by " + std::string(name(job.done_by));
  if (job.request.stop.error && !target_met(job.request.stop, a)) line += missed(job);
  for (const std::string& notice : a.notices) line += "; " + in_words(notice);
  return line;
}

}  // namespace raykiln::server
