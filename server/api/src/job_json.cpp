#include "raykiln/api/job_json.hpp"

#include <array>
#include <cmath>
#include <cstdio>

#include "effects_json.hpp"
#include "job_request_value.hpp"
#include "problem_value.hpp"
#include "raykiln/base/calendar.hpp"

namespace raykiln::server {
namespace {

using Json = nlohmann::ordered_json;

std::string dump(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Json time_or_null(const std::optional<WallTime>& time) {
  return time ? Json(rfc3339(*time)) : Json(nullptr);
}

template <class T>
Json value_or_null(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

/// The command that renders this sample again; "" for a picture that is no job of a server.
std::string replay_command(const JobId& job, const LocatedSample& at) {
  if (job.empty()) return {};
  return "raykiln replay " + job + ' ' + std::to_string(at.x) + ' ' + std::to_string(at.y) + ' ' +
         std::to_string(at.sample);
}

Json statistics_value(const JobId& job, const JobStatistics& s) {
  Json bad = Json::array();
  for (const auto& sample : s.bad_samples) {
    bad.push_back({{"x", sample.x},
                   {"y", sample.y},
                   {"sample", sample.sample},
                   {"replay", replay_command(job, sample)}});
  }
  return {{"rays", s.rays()},
          {"camera_rays", s.camera_rays},
          {"bounce_rays", s.bounce_rays},
          {"shadow_rays", s.shadow_rays},
          {"paths", s.paths},
          {"rays_per_second", s.rays_per_second()},
          {"non_finite_samples", s.non_finite},
          {"negative_samples", s.negative},
          {"truncated_paths", s.truncated},
          {"roulette_ends", s.roulette_ends},
          {"lights_at_hits", s.lights_at_hits},
          {"stream_calls", s.stream_calls},
          {"short_stream_calls", s.short_stream_calls},
          {"bad_samples", std::move(bad)},
          {"tree_build_seconds", value_or_null(s.tree_build_seconds)},
          {"tree_references", s.tree ? Json(s.tree->references) : Json(nullptr)},
          {"tree_bytes", s.tree ? Json(s.tree->bytes) : Json(nullptr)},
          {"tree_peak_bytes", s.tree ? Json(s.tree->peak_bytes) : Json(nullptr)},
          {"tree_budget_reached", s.tree ? Json(s.tree->budget_reached) : Json(nullptr)},
          {"prepare_seconds", s.prepare_seconds},
          {"render_seconds", s.render_seconds},
          {"worker_seconds", s.worker_seconds},
          {"traversal_seconds", s.traversal_seconds},
          {"shading_seconds", s.shading_seconds},
          {"idle_seconds", s.idle_seconds},
          {"merge_seconds", s.merge_seconds},
          {"publish_seconds", s.publish_seconds},
          {"accuracy_seconds", s.accuracy_seconds},
          {"overhead_fraction", s.overhead_fraction()},
          {"tasks", s.tasks},
          {"retried_tasks", s.retried_tasks},
          {"film_bytes", s.film_bytes}};
}

Json progress_value(const JobSnapshot& job) {
  const auto& p = job.progress;
  return {{"fraction", p.fraction()},
          {"samples_done", p.samples_per_pixel},
          {"samples_target", job.request.stop.samples},
          {"tiles_started", p.tiles_started},
          {"tiles_done", p.tiles_done},
          {"tiles_total", p.tiles}};
}

Json prepare_value(const JobSnapshot& job) {
  if (job.state != JobState::kPreparing) return nullptr;
  const auto stage = job.prepare.stage == PrepareStage::kNone ? PrepareStage::kWaiting
                                                              : job.prepare.stage;
  return {{"stage", name(stage)}, {"fraction", job.prepare.fraction}};
}

Json image_value(const JobSnapshot& job) {
  if (job.image_revision == 0) return nullptr;
  const std::string revision = std::to_string(job.image_revision);
  const std::string base = "/v1/jobs/" + job.id + "/image?format=";
  return {{"revision", job.image_revision},
          {"png", base + "png&rev=" + revision},
          {"exr", base + "exr&rev=" + revision}};
}

Json figure_value(const ErrorFigure& figure) {
  return {{"value", figure.value}, {"low", figure.low}, {"high", figure.high}};
}

Json accuracy_value(const JobSnapshot& job) {
  if (!job.accuracy) return nullptr;
  const PictureError& a = *job.accuracy;
  const auto if_known = [&](const ErrorFigure& figure) { return a.known() ? figure_value(figure) : Json(nullptr); };
  const auto& target = job.request.stop.error;
  Json remarks = Json::array();
  for (const std::string& notice : a.notices) remarks.push_back(remark(notice));
  return {{"grade", a.grade},
          {"error", if_known(a.error)},
          {"rmse", if_known(a.rmse)},
          {"display_rmse", if_known(a.display_rmse)},
          {"heavy_tailed", a.heavy_tailed},
          {"notices", a.notices},
          {"remarks", std::move(remarks)},
          {"least_samples", a.least_samples},
          {"target", value_or_null(target)},
          {"target_reached", target ? Json(target_met(job.request.stop, a)) : Json(nullptr)}};
}

Json continues_value(const JobSnapshot& job) {
  if (job.continues.empty()) return nullptr;
  return {{"job", job.continues}, {"samples", job.continued_samples}};
}

Json job_value(const JobSnapshot& job) {
  Json warnings = Json::array();
  for (const auto& warning : job.warnings) {
    warnings.push_back(
        {{"code", warning.code}, {"message", warning.message}, {"where", warning.where}});
  }
  return {{"id", job.id},
          {"scene", job.request.scene},
          {"name", job.request.name},
          {"state", name(job.state)},
          {"revision", job.revision},
          {"created_at", rfc3339(job.created)},
          {"started_at", time_or_null(job.started)},
          {"finished_at", time_or_null(job.finished)},
          {"request", job_request_value(job.request)},
          {"queue_position", value_or_null(job.queue_position)},
          {"prepare", prepare_value(job)},
          {"progress", progress_value(job)},
          {"elapsed_seconds", job.elapsed_seconds},
          {"remaining_seconds", is_final(job.state) ? Json(nullptr) : value_or_null(job.remaining_seconds)},
          {"statistics", statistics_value(job.id, job.statistics)},
          {"accuracy", accuracy_value(job)},
          {"continues", continues_value(job)},
          {"done_by", job.done_by == DoneBy::kNone ? Json(nullptr) : Json(name(job.done_by))},
          {"effects", effect_report_value(job.effects)},
          {"warnings", std::move(warnings)},
          {"error", error_value(job.error)},
          {"image", image_value(job)}};
}

}  // namespace

std::string rfc3339(WallTime time) {
  using std::chrono::milliseconds;
  const auto since = std::chrono::floor<milliseconds>(time.time_since_epoch());
  const auto seconds = std::chrono::floor<std::chrono::seconds>(since);
  const UtcTime utc(time);
  std::array<char, 32> date{};
  std::snprintf(date.data(), date.size(), "%04d-%02u-%02uT", static_cast<int>(utc.date.year()),
                static_cast<unsigned>(utc.date.month()), static_cast<unsigned>(utc.date.day()));
  const std::string thousandths = std::to_string(1000 + (since - seconds).count());
  return date.data() + utc.clock() + '.' + thousandths.substr(1) + 'Z';
}

std::string job_json(const JobSnapshot& job) { return dump(job_value(job)); }

std::string job_page_json(const std::vector<JobSnapshot>& jobs, const std::string& next_cursor) {
  Json list = Json::array();
  for (const auto& job : jobs) list.push_back(job_value(job));
  return dump({{"jobs", std::move(list)},
               {"next_cursor", next_cursor.empty() ? Json(nullptr) : Json(next_cursor)}});
}

}  // namespace raykiln::server
