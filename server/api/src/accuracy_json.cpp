// What GET /v1/jobs/{job}/accuracy answers.
#include <nlohmann/json.hpp>

#include "raykiln/api/job_json.hpp"

namespace raykiln::server {
namespace {

using Json = nlohmann::ordered_json;

Json range_value(const TimeRange& range) {
  return {{"value", range.value}, {"low", range.low}, {"high", range.high}};
}

Json figure_value(const ErrorFigure& f) { return {{"value", f.value}, {"low", f.low}, {"high", f.high}}; }

/// Render seconds from now on; nothing of it is negative.
Json left_value(const std::optional<TimeRange>& range, double now) {
  if (!range) return nullptr;
  const auto left = [now](double seconds) { return std::max(0.0, seconds - now); };
  return range_value({left(range->value), left(range->low), left(range->high)});
}

Json points_value(const std::vector<CurvePoint>& curve) {
  Json points = Json::array();
  for (const CurvePoint& p : curve) {
    points.push_back({{"render_seconds", p.render_seconds},
                      {"worker_seconds", p.worker_seconds},
                      {"samples", p.samples},
                      {"rays", p.rays},
                      {"error", figure_value(p.error)}});
  }
  return points;
}

Json forecasts_value(const std::vector<Forecast>& list) {
  Json forecasts = Json::array();
  for (const Forecast& f : list) {
    forecasts.push_back({{"made_at_seconds", f.made_at},
                         {"error", f.error},
                         {"seconds", range_value(f.seconds)},
                         {"actual_seconds", f.actual ? Json(*f.actual) : Json(nullptr)},
                         {"hit", f.actual ? Json(f.hit()) : Json(nullptr)}});
  }
  return forecasts;
}

Basis basis_of(const JobSnapshot& job) {
  return job.accuracy ? server::basis_of(*job.accuracy) : Basis::kRough;
}

/// Whether a job with this target would end here.
bool reached(const JobSnapshot& job, double error) {
  StopRule rule;
  rule.error = error;
  return job.accuracy && target_met(rule, *job.accuracy);
}

/// Errors that have a price.
constexpr double kPriced[] = {0.1, 0.05, 0.02, 0.01, 0.005};

/// Nothing of the error is known below the floor of samples.
Json prices_value(const JobSnapshot& job) {
  const Basis basis = basis_of(job);
  const double now = job.statistics.render_seconds;
  Json prices = Json::array();
  for (const double error : kPriced) {
    const auto total = seconds_to_error(job.curve, error, basis);
    prices.push_back({{"error", error},
                      {"reached", reached(job, error)},
                      {"seconds", total ? range_value(*total) : Json(nullptr)},
                      {"seconds_left", left_value(total, now)}});
  }
  return prices;
}

std::string dump(const Json& value) { return value.dump(-1, ' ', false, Json::error_handler_t::replace); }

}  // namespace

std::string quote_json(const JobSnapshot& job) {
  const auto& a = job.accuracy;
  return dump({{"id", job.id},
               {"job", "/v1/jobs/" + job.id},
               {"state", name(job.state)},
               {"pilot", {{"seconds", job.statistics.render_seconds},
                          {"worker_seconds", job.statistics.worker_seconds},
                          {"samples", job.progress.samples_per_pixel}}},
               {"error", a && a->known() ? figure_value(a->error) : Json(nullptr)},
               {"heavy_tailed", a ? Json(a->heavy_tailed) : Json(nullptr)},
               {"prices", prices_value(job)}});
}

std::string accuracy_json(const JobSnapshot& job) {
  const Basis basis = basis_of(job);
  const double now = job.statistics.render_seconds;
  const double error = job.curve.empty() ? 0.0 : job.curve.back().error.value;
  const auto& target = job.request.stop.error;
  const auto fit = fit_slope(job.curve);
  Json slope = nullptr;
  if (fit) slope = {{"value", fit->slope}, {"standard_error", fit->standard_error}, {"points", fit->points}};
  Json value{{"job", job.id},
             {"revision", job.revision},
             {"points", points_value(job.curve)},
             {"slope", std::move(slope)},
             {"seconds_to_halve_error", left_value(seconds_to_error(job.curve, error / 2.0, basis), now)},
             {"target", target ? Json(*target) : Json(nullptr)},
             {"seconds_to_target",
              target ? left_value(seconds_to_error(job.curve, *target, basis), now) : Json(nullptr)},
             {"prices", prices_value(job)},
             {"forecasts", forecasts_value(job.forecasts)},
             {"tile_samples", job.tile_samples.empty() ? Json(nullptr) : Json(job.tile_samples)}};
  return dump(value);
}

}  // namespace raykiln::server
