// The client's side: schema Job read back, leniently (fields may be added), but typed.
#include <nlohmann/json.hpp>

#include "problem_value.hpp"
#include "raykiln/api/job_json.hpp"

namespace raykiln::server {
namespace {

using nlohmann::json;

PictureError error_of(const json& accuracy, double samples) {
  PictureError view;
  view.grade = accuracy.at("grade").get<std::string>();
  if (const json& error = accuracy.at("error"); error.is_object()) {
    view.error = {error.at("value").get<double>(), error.at("low").get<double>(), error.at("high").get<double>()};
  } else {
    view.grade = PictureError().grade;  // no figure, so nothing is known
  }
  view.notices = accuracy.at("notices").get<std::vector<std::string>>();
  view.mean_samples = samples;
  return view;
}

std::string warning_text(const json& warning) {
  const auto where = warning.at("where").get<std::string>();
  return warning.at("message").get<std::string>() + (where.empty() ? "" : " (" + where + ')');
}

/// Throws json::exception when something that a job must have is missing.
JobView view_of(const json& job) {
  JobView view;
  view.id = job.at("id").get<std::string>();
  view.scene = job.at("scene").get<std::string>();
  view.name = job.at("name").get<std::string>();
  view.state = job.at("state").get<std::string>();
  view.revision = job.at("revision").get<std::uint64_t>();
  const json& progress = job.at("progress");
  view.fraction = progress.at("fraction").get<double>();
  view.samples_done = progress.at("samples_done").get<double>();
  view.samples_target = progress.at("samples_target").get<double>();
  view.elapsed_seconds = job.at("elapsed_seconds").get<double>();
  if (const json& left = job.at("remaining_seconds"); left.is_number()) {
    view.remaining_seconds = left.get<double>();
  }
  view.rays_per_second = job.at("statistics").at("rays_per_second").get<double>();
  const auto effects = job.find("effects");
  if (effects != job.end() && effects->is_object() && effects->at("approximation").get<bool>()) {
    view.approximation = effects->at("label").get<std::string>();
  }
  view.render_seconds = job.at("statistics").at("render_seconds").get<double>();
  if (const json& accuracy = job.at("accuracy"); accuracy.is_object()) {
    view.accuracy = error_of(accuracy, view.samples_done);
    if (const json& target = accuracy.at("target"); target.is_number()) view.target = target.get<double>();
    view.target_reached = accuracy.at("target_reached") == true;
  }
  if (const json& by = job.at("done_by"); by.is_string()) view.done_by = done_by_named(by.get<std::string>());
  for (const json& warning : job.at("warnings")) view.warnings.push_back(warning_text(warning));
  view.has_image = !job.at("image").is_null();
  if (const json& prepare = job.at("prepare"); prepare.is_object()) {
    view.stage = prepare.at("stage").get<std::string>();
    view.fraction = prepare.at("fraction").get<double>();
  }
  if (const json& error = job.at("error"); error.is_object()) view.error = error_text(error);
  return view;
}

QuoteView::Price price_of(const json& price) {
  QuoteView::Price view{price.at("error").get<double>(), price.at("reached").get<bool>()};
  if (const json& left = price.at("seconds_left"); left.is_object()) {
    view.left = {left.at("low").get<double>(), left.at("high").get<double>()};
  }
  return view;
}

}  // namespace

std::optional<QuoteView> parse_quote_view(std::string_view text) {
  try {
    const json quote = json::parse(text.begin(), text.end());
    QuoteView view;
    view.id = quote.at("id").get<std::string>();
    view.samples = quote.at("pilot").at("samples").get<double>();
    view.heavy_tailed = quote.at("heavy_tailed").is_boolean() && quote["heavy_tailed"].get<bool>();
    for (const json& price : quote.at("prices")) view.prices.push_back(price_of(price));
    return view;
  } catch (const json::exception&) {
    return std::nullopt;
  }
}

std::optional<JobView> parse_job_view(std::string_view text) {
  try {
    return view_of(json::parse(text.begin(), text.end()));
  } catch (const json::exception&) {
    return std::nullopt;
  }
}

std::optional<JobPageView> parse_job_page(std::string_view text) {
  try {
    const json page = json::parse(text.begin(), text.end());
    JobPageView view;
    for (const json& job : page.at("jobs")) view.jobs.push_back(view_of(job));
    if (page.at("next_cursor").is_string()) view.next_cursor = page["next_cursor"].get<std::string>();
    return view;
  } catch (const json::exception&) {
    return std::nullopt;
  }
}

}  // namespace raykiln::server
