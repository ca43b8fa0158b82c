// One sample of a job once more.
#include "await.hpp"
#include "query.hpp"
#include "raykiln/api/api.hpp"
#include "raykiln/api/replay_json.hpp"
#include "raykiln/render/replay.hpp"

namespace raykiln::server {
namespace {

/// A replay takes a handler thread for as long as one sample renders, and there are 8.
constexpr int kMaxReplays = 2;

std::optional<std::uint64_t> required(const Request& request, std::string_view name,
                                      std::uint64_t end) {
  if (find_value(request.query, name) == nullptr || end == 0) return std::nullopt;
  return query_natural(request, name, 0, end - 1, 0);
}

Problem out_of_range(std::string name, std::uint64_t end) {
  return invalid_parameter(std::move(name),
                           "must be given, an integer from 0 to " + std::to_string(end - 1));
}

/// Counts those under way, whatever way they end.
class Place {
 public:
  explicit Place(std::atomic<int>& taken) : taken_(taken), mine_(taken_.fetch_add(1)) {}
  ~Place() { taken_.fetch_sub(1); }
  Place(const Place&) = delete;
  Place& operator=(const Place&) = delete;
  [[nodiscard]] bool free() const { return mine_ < kMaxReplays; }

 private:
  std::atomic<int>& taken_;
  const int mine_;
};

}  // namespace

Answer Api::replay_sample(const Request& request) {
  if (auto problem = check_query(request, {"x", "y", "sample"})) return to_response(*problem);
  if (auto problem = check_job_id(request)) return to_response(*problem);
  const std::string id = path_parameter(request, "job");
  const auto job = await<JobSnapshot>([&](auto reply) { parts_.scheduler.get(id, std::move(reply)); });
  if (!job) return to_response(problem_of(job.error()));
  const JobRequest& asked = job->request;
  const auto width = static_cast<std::uint64_t>(asked.width);
  const auto height = static_cast<std::uint64_t>(asked.height);
  const auto x = required(request, "x", width);
  if (!x) return to_response(out_of_range("x", width));
  const auto y = required(request, "y", height);
  if (!y) return to_response(out_of_range("y", height));
  const auto sample = required(request, "sample", config_.jobs.max_samples);
  if (!sample) return to_response(out_of_range("sample", config_.jobs.max_samples));

  const Place place(replays_);
  if (!place.free()) {
    return to_response(problem_of({ErrorKind::kTooMany, "too_many_replays", "others are being replayed", "", 1}));
  }
  const auto inputs = await<ReplayInputs>(
      [&](auto reply) { parts_.scheduler.replay_inputs(id, std::move(reply)); });
  if (!inputs) return to_response(problem_of(inputs.error()));
  ReplayView view;
  view.x = static_cast<int>(*x);
  view.y = static_cast<int>(*y);
  view.sample = *sample;
  const auto replayed =
      render::replay_sample(*inputs->scene, inputs->settings, view.x, view.y, view.sample);
  view.radiance = {replayed.radiance.x, replayed.radiance.y, replayed.radiance.z};
  view.dropped = replayed.dropped;
  view.truncated = replayed.truncated;
  view.bounce_rays = replayed.stats.bounce_rays;
  view.shadow_rays = replayed.stats.shadow_rays;
  view.light_model = light_model_label(asked.light_model, asked.light_model_overrides);
  view.seed = asked.seed;
  view.effects = inputs->effects.label;
  return json_response(200, replay_json(view));
}

}  // namespace raykiln::server
