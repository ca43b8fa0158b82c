#include <unistd.h>

#include <cstdio>
#include <iomanip>
#include <iostream>

#include "accuracy_line.hpp"
#include "raykiln/api/percent.hpp"
#include "raykiln/api/scene_json.hpp"
#include "remote.hpp"
#include "text_format.hpp"

namespace raykiln::server {
namespace {

bool on_terminal() { return isatty(STDERR_FILENO) != 0; }

/// Follows, prints the outcome, and fetches the pictures that are asked for.
ExitCode see_through(Remote& remote, const CliOptions& options, const std::string& job) {
  std::string json;
  ProgressLine line(std::cerr, on_terminal(), options.quiet);
  const auto end = remote.follow(job, line, &json);
  line.finish();
  if (!end) return remote.failure();
  const auto outcome = exit_code_for_state(end->state);
  if (options.json) std::cout << json << '\n';
  else if (!options.quiet) std::cerr << "job " << job << ' ' << end->state << '\n';
  if (!options.quiet) {
    for (const std::string& warning : end->warnings) remote.warn(warning);
    if (end->accuracy) std::cerr << accuracy_line(*end) << '\n';
  }
  if (!end->approximation.empty()) {
    std::cerr << "warning: deliberate approximation: effects " << end->approximation << '\n';
  }
  if (!end->error.empty()) std::cerr << "raykiln: " << end->error << '\n';
  if (!options.outputs.empty() && end->has_image) {
    const auto fetched = fetch_pictures(remote, options, job);
    if (fetched != ExitCode::kOk && outcome == ExitCode::kOk) return fetched;
  }
  return outcome;
}

/// A job that was created: followed to its end where that is asked for, else its id is printed.
ExitCode see_created(Remote& remote, const CliOptions& options, const ClientResponse& answer) {
  const auto job = parse_job_view(answer.body);
  if (!job) return remote.fail(ExitCode::kFailure, "the server's answer is no job");
  if (options.wait || !options.outputs.empty()) {
    if (!options.json) std::cout << job->id << std::endl;
    return see_through(remote, options, job->id);
  }
  std::cout << (options.json ? answer.body : job->id) << '\n';
  return ExitCode::kOk;
}

std::string percent_of(double fraction) { return short_number(100.0 * fraction) + " %"; }

void print_prices(const QuoteView& quote) {
  for (const auto& price : quote.prices) {
    std::cout << "error " << std::left << std::setw(6) << percent_of(price.error);
    if (price.reached) std::cout << "  reached\n";
    else if (!price.left) std::cout << "  unknown\n";
    else std::cout << "  " << short_number(price.left->first) << " to " << short_number(price.left->second) << " s more\n";
  }
  if (quote.heavy_tailed) std::cout << "rare bright samples: the ranges are three times as wide\n";
  std::cout << "raykiln extend " << quote.id << " --error 1% goes on from " << short_number(quote.samples) << " samples a pixel\n";
}

}  // namespace

ExitCode submit_command(const CliOptions& options) {
  auto remote = Remote::open(options);
  if (!remote) return ExitCode::kUsage;
  const auto scene = upload_scene(*remote, options);
  if (!scene) return remote->failure();
  JobRequest request = options.picture.request;
  request.scene = *scene;
  ClientHeaders headers{{"Content-Type", "application/json"}};
  if (!options.idempotency_key.empty()) headers.emplace_back("Idempotency-Key", options.idempotency_key);
  const auto answer = remote->ask("POST", "/v1/jobs", headers, job_request_json(request));
  if (!answer) return remote->failure();
  return see_created(*remote, options, *answer);
}

ExitCode extend_command(const CliOptions& options) {
  auto remote = Remote::open(options);
  if (!remote) return ExitCode::kUsage;
  const auto answer = remote->ask("POST", "/v1/jobs/" + percent_encode(options.job) + "/extend",
                                  {{"Content-Type", "application/json"}},
                                  extension_json({options.picture.request.stop, std::nullopt}));
  if (!answer) return remote->failure();
  return see_created(*remote, options, *answer);
}

ExitCode quote_command(const CliOptions& options) {
  auto remote = Remote::open(options);
  if (!remote) return ExitCode::kUsage;
  const auto scene = upload_scene(*remote, options);
  if (!scene) return remote->failure();
  JobRequest request = options.picture.request;
  request.scene = *scene;
  const auto answer = remote->ask("POST", "/v1/quotes", {{"Content-Type", "application/json"}},
                                  quote_request_json(request, options.pilot_seconds));
  if (!answer) return remote->failure();
  const auto pilot = parse_quote_view(answer->body);
  if (!pilot) return remote->fail(ExitCode::kFailure, "the server's answer is no quote");
  ProgressLine line(std::cerr, on_terminal(), options.quiet);
  const auto end = remote->follow(pilot->id, line, nullptr);
  line.finish();
  if (!end) return remote->failure();
  if (end->state != "completed") {
    std::cerr << "raykiln: the pilot " << end->state << (end->error.empty() ? "" : ": " + end->error) << '\n';
    return exit_code_for_state(end->state);
  }
  const auto prices = remote->ask("GET", "/v1/quotes/" + pilot->id);
  if (!prices) return remote->failure();
  const auto quote = parse_quote_view(prices->body);
  if (!quote) return remote->fail(ExitCode::kFailure, "the server's answer is no quote");
  if (options.json) std::cout << prices->body << '\n';
  else print_prices(*quote);
  return ExitCode::kOk;
}

ExitCode watch_command(const CliOptions& options) {
  auto remote = Remote::open(options);
  if (!remote) return ExitCode::kUsage;
  return see_through(*remote, options, percent_encode(options.job));
}

ExitCode fetch_command(const CliOptions& options) {
  auto remote = Remote::open(options);
  if (!remote) return ExitCode::kUsage;
  return fetch_pictures(*remote, options, percent_encode(options.job));
}

ExitCode cancel_command(const CliOptions& options) {
  auto remote = Remote::open(options);
  if (!remote) return ExitCode::kUsage;
  const auto answer = remote->ask("POST", "/v1/jobs/" + percent_encode(options.job) + "/cancel");
  if (!answer) return remote->failure();
  if (options.json) std::cout << answer->body << '\n';
  return ExitCode::kOk;
}

ExitCode scenes_command(const CliOptions& options) {
  auto remote = Remote::open(options);
  if (!remote) return ExitCode::kUsage;
  std::string cursor;
  do {
    const auto answer = remote->ask("GET", "/v1/scenes?limit=200" + (cursor.empty() ? "" : "&cursor=" + cursor));
    if (!answer) return remote->failure();
    const auto page = parse_scene_page(answer->body);
    if (!page) return remote->fail(ExitCode::kFailure, "the server's answer is no list of scenes");
    if (options.json) std::cout << answer->body << '\n';
    for (const auto& scene : page->scenes) {
      if (options.json) break;
      std::cout << scene.id << "  " << std::setw(10) << scene.triangles << " triangles  "
                << clean(scene.name) << '\n';
    }
    cursor = percent_encode(page->next_cursor);
  } while (!cursor.empty());
  return ExitCode::kOk;
}

ExitCode jobs_command(const CliOptions& options) {
  auto remote = Remote::open(options);
  if (!remote) return ExitCode::kUsage;
  std::string cursor;
  const std::string filter = options.state.empty() ? "" : "&state=" + percent_encode(options.state);
  do {
    const auto answer = remote->ask("GET", "/v1/jobs?limit=200" + filter + (cursor.empty() ? "" : "&cursor=" + cursor));
    if (!answer) return remote->failure();
    const auto page = parse_job_page(answer->body);
    if (!page) return remote->fail(ExitCode::kFailure, "the server's answer is no list of jobs");
    if (options.json) std::cout << answer->body << '\n';
    for (const auto& job : page->jobs) {
      if (options.json) break;
      std::cout << std::left << std::setw(32) << job.id << std::setw(12) << job.state << std::right
                << std::setw(4) << static_cast<int>(job.fraction * 100.0) << " %  "
                << clean(job.name)
                << (job.approximation.empty() ? "" : "  (approximation: " + job.approximation + ')') << '\n';
    }
    cursor = percent_encode(page->next_cursor);
  } while (!cursor.empty());
  return ExitCode::kOk;
}

ExitCode health_command(const CliOptions& options) {
  auto remote = Remote::open(options);
  if (!remote) return ExitCode::kUsage;
  const auto answer =
      remote->check(HttpClient(remote->address(), std::chrono::seconds(5)).request("GET", "/readyz"));
  if (!answer) return remote->failure();
  if (!options.quiet) std::cout << answer->body << '\n';
  return ExitCode::kOk;
}

}  // namespace raykiln::server
