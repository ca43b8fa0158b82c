#include "../json_fields.hpp"
#include "batch_result.hpp"

namespace raykiln::server {
namespace {

const char* verdict(const PictureResult& r) {
  if (r.state != PictureState::kCompleted) return name(r.state);
  switch (outcome(r)) {
    case ExitCode::kImageDiffers: return r.reference_missing ? "no_reference" : "differs";
    case ExitCode::kLimitReached: return "limit_reached";
    default: return r.comparison ? "same" : "done";
  }
}

std::string picture_json(const PlannedPicture& planned, const PictureResult& r) {
  JsonFields f;
  f.text("name", planned.name);
  f.text("state", name(r.state));
  f.text("verdict", verdict(r));
  f.text("text", verdict_line(r));
  f.text("scene_path", planned.scene.string());
  f.text("scene", r.scene);
  f.raw("job", r.job.empty() ? "null" : json_string(r.job));
  f.flag("reused", r.reused);
  f.number("seconds", r.seconds);
  f.number("samples", r.samples);
  f.raw("error", r.error_reached ? json_number(*r.error_reached) : "null");
  f.raw("failure", r.failure.empty() ? "null" : json_string(r.failure));
  f.raw("reference", planned.reference.empty() ? "null" : json_string(planned.reference.string()));
  f.text("picture", r.state == PictureState::kCompleted ? picture_file(planned.name, ".exr").string() : "");
  f.raw("comparison", r.comparison ? comparison_json(*r.comparison) : "null");
  return f.object();
}

}  // namespace

std::string batch_json(const BatchResult& result) {
  JsonFields counts;
  counts.number("total", static_cast<double>(result.pictures.size()));
  for (const PictureState state : {PictureState::kCompleted, PictureState::kFailed, PictureState::kCancelled,
                                   PictureState::kSkipped, PictureState::kWaiting}) {
    counts.number(name(state), static_cast<double>(result.count(state)));
  }
  counts.number("differing", static_cast<double>(result.differing()));
  counts.number("reused", static_cast<double>(result.reused()));
  std::vector<std::string> pictures;
  for (std::size_t i = 0; i < result.pictures.size(); ++i) {
    pictures.push_back(picture_json(result.plan.pictures[i], result.pictures[i]));
  }
  JsonFields f;
  f.text("name", result.plan.name);
  f.raw("batch", result.batch.empty() ? "null" : json_string(result.batch));
  f.number("exit_code", to_int(outcome(result)));
  f.text("summary", summary(result));
  f.number("seconds", result.seconds);
  f.number("false_alarms", result.plan.false_alarms);
  f.raw("counts", counts.object());
  f.raw("pictures", json_array(pictures));
  return f.object();
}

}  // namespace raykiln::server
