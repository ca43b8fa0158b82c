#include "batch_result.hpp"

#include <algorithm>

namespace raykiln::server {

const char* name(PictureState state) {
  switch (state) {
    case PictureState::kCompleted: return "completed";
    case PictureState::kFailed: return "failed";
    case PictureState::kCancelled: return "cancelled";
    case PictureState::kSkipped: return "skipped";
    case PictureState::kWaiting: break;
  }
  return "waiting";
}

ExitCode outcome(const PictureResult& r) {
  if (r.state == PictureState::kFailed) return ExitCode::kJobFailed;
  if (r.state != PictureState::kCompleted) return ExitCode::kJobCancelled;
  if (r.reference_missing || (r.comparison && r.comparison->differs)) return ExitCode::kImageDiffers;
  return r.limit_reached ? ExitCode::kLimitReached : ExitCode::kOk;
}

std::size_t BatchResult::count(PictureState state) const {
  return static_cast<std::size_t>(std::count_if(pictures.begin(), pictures.end(),
                                                [state](const PictureResult& r) { return r.state == state; }));
}
std::size_t BatchResult::differing() const {
  return static_cast<std::size_t>(std::count_if(pictures.begin(), pictures.end(), [](const PictureResult& r) {
    return outcome(r) == ExitCode::kImageDiffers;
  }));
}
std::size_t BatchResult::reused() const {
  return static_cast<std::size_t>(
      std::count_if(pictures.begin(), pictures.end(), [](const PictureResult& r) { return r.reused; }));
}

ExitCode outcome(const BatchResult& result) {
  if (result.wait_ended) return ExitCode::kWaitEnded;
  for (const ExitCode grave : {ExitCode::kJobFailed, ExitCode::kJobCancelled, ExitCode::kImageDiffers,
                               ExitCode::kLimitReached}) {
    const bool there = std::any_of(result.pictures.begin(), result.pictures.end(),
                                   [grave](const PictureResult& r) { return outcome(r) == grave; });
    if (there) return grave;
  }
  return ExitCode::kOk;
}

std::string summary(const BatchResult& result) {
  std::string text = std::to_string(result.pictures.size()) + " pictures: " +
                     std::to_string(result.count(PictureState::kCompleted)) + " completed";
  if (result.reused() > 0) text += " (" + std::to_string(result.reused()) + " reused)";
  for (const PictureState state : {PictureState::kFailed, PictureState::kCancelled, PictureState::kSkipped,
                                   PictureState::kWaiting}) {
    if (result.count(state) > 0) text += ", " + std::to_string(result.count(state)) + ' ' + name(state);
  }
  if (result.differing() > 0) {
    text += "; " + std::to_string(result.differing()) + (result.differing() == 1 ? " differs" : " differ") +
            " from the reference";
  }
  return text;
}

std::string verdict_line(const PictureResult& r) {
  if (r.state == PictureState::kFailed) return r.failure;
  if (r.state == PictureState::kSkipped) return "skipped: another picture failed first";
  if (r.state == PictureState::kWaiting) return "it had not ended when the wait did";
  if (r.state != PictureState::kCompleted) return name(r.state);
  if (r.reference_missing) return "there is no reference yet: look at the picture, then raykiln approve";
  if (r.comparison) return r.comparison->reason;
  return r.limit_reached ? "a limit was reached before the error target" : "no reference";
}

std::filesystem::path picture_file(const std::string& picture, const std::string& ending) {
  return std::filesystem::path("pictures") / (picture + ending);
}

}  // namespace raykiln::server
