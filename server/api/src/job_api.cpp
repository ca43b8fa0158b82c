#include <algorithm>

#include "await.hpp"
#include "job_feed.hpp"
#include "json_post.hpp"
#include "query.hpp"
#include "raykiln/api/api.hpp"
#include "raykiln/api/job_json.hpp"

namespace raykiln::server {
namespace {

Response job_answer(int status, const JobSnapshot& job) {
  auto response = json_response(status, job_json(job));
  response.headers.emplace_back("Location", "/v1/jobs/" + job.id);
  return response;
}

/// A body of JSON for something new; its key, if it has one.
std::optional<Problem> check_creation(const Request& request) {
  if (auto problem = check_query(request, {})) return problem;
  return check_json_post(request);
}

std::string idempotency_key(const Request& request) {
  const auto* key = find_value(request.headers, "idempotency-key");
  return key == nullptr ? std::string() : *key;
}

}  // namespace

Answer Api::create_job(const Request& request) {
  if (auto problem = check_creation(request)) return to_response(*problem);
  auto parsed = parse_job_request(request.body, config_.jobs);
  if (const auto* problem = std::get_if<Problem>(&parsed)) return to_response(*problem);
  SubmitJob submission{std::get<JobRequest>(std::move(parsed)), idempotency_key(request)};
  const auto result = await<SubmittedJob>([&](auto reply) {
    parts_.scheduler.submit(std::move(submission), std::move(reply));
  });
  if (!result) return to_response(problem_of(result.error()));
  return job_answer(result->reused ? 200 : 202, result->job);
}

Answer Api::extend_job(const Request& request) {
  if (auto problem = check_job_id(request)) return to_response(*problem);
  if (auto problem = check_creation(request)) return to_response(*problem);
  auto parsed = parse_extension(request.body, config_.jobs);
  if (const auto* problem = std::get_if<Problem>(&parsed)) return to_response(*problem);
  auto& wanted = std::get<Extension>(parsed);
  ExtendJob extension{path_parameter(request, "job"), std::move(wanted.stop), wanted.priority, idempotency_key(request)};
  const auto result = await<SubmittedJob>([&](auto reply) {
    parts_.scheduler.extend(std::move(extension), std::move(reply));
  });
  if (!result) return to_response(problem_of(result.error()));
  return job_answer(202, result->job);
}

Answer Api::create_quote(const Request& request) {
  if (auto problem = check_creation(request)) return to_response(*problem);
  auto parsed = parse_quote_request(request.body, config_.jobs);
  if (const auto* problem = std::get_if<Problem>(&parsed)) return to_response(*problem);
  SubmitJob submission{std::get<JobRequest>(std::move(parsed)), idempotency_key(request)};
  const auto result = await<SubmittedJob>([&](auto reply) {
    parts_.scheduler.submit(std::move(submission), std::move(reply));
  });
  if (!result) return to_response(problem_of(result.error()));
  auto response = json_response(202, quote_json(result->job));
  response.headers.emplace_back("Location", "/v1/quotes/" + result->job.id);
  return response;
}

Answer Api::get_quote(const Request& request) {
  if (auto problem = check_query(request, {})) return to_response(*problem);
  if (auto problem = check_job_id(request)) return to_response(*problem);
  const auto job = await<JobSnapshot>([&](auto reply) {
    parts_.scheduler.get(path_parameter(request, "job"), std::move(reply));
  });
  if (!job) return to_response(problem_of(job.error()));
  return json_response(200, quote_json(*job));
}

Answer Api::list_jobs(const Request& request) {
  if (auto problem = check_query(request, {"limit", "cursor", "state", "scene"})) {
    return to_response(*problem);
  }
  ListJobs query;
  const auto limit = query_natural(request, "limit", 1, 200, 50);
  if (!limit) return to_response(invalid_parameter("limit", "must be an integer from 1 to 200"));
  query.limit = *limit;
  query.cursor = query_text(request, "cursor");
  query.scene = query_text(request, "scene");
  std::string_view states;
  if (const auto* text = find_value(request.query, "state")) states = *text;
  while (!states.empty()) {
    const auto comma = std::min(states.find(','), states.size());
    const auto state = job_state_named(states.substr(0, comma));
    if (!state || query.states.size() == std::size(kAllJobStates)) {
      return to_response(invalid_parameter("state", "must be states of a job separated by commas"));
    }
    query.states.push_back(*state);
    states.remove_prefix(std::min(comma + 1, states.size()));
  }
  const auto page = await<JobPage>([&](auto reply) {
    parts_.scheduler.list(std::move(query), std::move(reply));
  });
  if (!page) return to_response(problem_of(page.error()));
  return json_response(200, job_page_json(page->jobs, page->next_cursor));
}

Answer Api::get_job(const Request& request) {
  if (auto problem = check_query(request, {})) return to_response(*problem);
  if (auto problem = check_job_id(request)) return to_response(*problem);
  const auto job = await<JobSnapshot>([&](auto reply) {
    parts_.scheduler.get(path_parameter(request, "job"), std::move(reply));
  });
  if (!job) return to_response(problem_of(job.error()));
  return json_response(200, job_json(*job));
}

Answer Api::get_accuracy(const Request& request) {
  if (auto problem = check_query(request, {})) return to_response(*problem);
  if (auto problem = check_job_id(request)) return to_response(*problem);
  const auto job = await<JobSnapshot>([&](auto reply) {
    parts_.scheduler.get(path_parameter(request, "job"), std::move(reply));
  });
  if (!job) return to_response(problem_of(job.error()));
  return json_response(200, accuracy_json(*job));
}

Answer Api::cancel_job(const Request& request) {
  if (auto problem = check_query(request, {})) return to_response(*problem);
  if (auto problem = check_job_id(request)) return to_response(*problem);
  const auto job = await<JobSnapshot>([&](auto reply) {
    parts_.scheduler.cancel(path_parameter(request, "job"), std::move(reply));
  });
  if (!job) return to_response(problem_of(job.error()));
  return job_answer(202, *job);
}

Answer Api::watch_job(const Request& request) {
  if (auto problem = check_query(request, {})) return to_response(*problem);
  if (auto problem = check_job_id(request)) return to_response(*problem);
  const std::string id = path_parameter(request, "job");
  if (const auto* last = find_value(request.headers, "last-event-id")) {
    const auto job = await<JobSnapshot>(
        [&](auto reply) { parts_.scheduler.get(id, std::move(reply)); });
    if (job && is_final(job->state) && *last == std::to_string(job->revision)) {
      Response nothing_more;
      nothing_more.status = 204;
      return nothing_more;
    }
  }
  auto relay = std::make_shared<WakeRelay>();
  auto subscription = await<std::unique_ptr<Subscription>>([&](auto reply) {
    parts_.scheduler.watch(id, [relay] { relay->wake(); }, std::move(reply));
  });
  if (!subscription) return to_response(problem_of(subscription.error()));
  return std::make_unique<JobFeed>(std::move(relay), std::move(subscription).value());
}

}  // namespace raykiln::server
