#include "remote.hpp"

#include <iostream>
#include <thread>

#include "output_file.hpp"
#include "raykiln/api/scene_json.hpp"
#include "raykiln/app/sse_reader.hpp"

namespace raykiln::server {
namespace {

constexpr int kMaxReconnects = 30;

bool is_final_state(const std::string& state) {
  const auto known = job_state_named(state);
  return known && is_final(*known);
}

}  // namespace

ProgressState progress_of(const JobView& job) {
  ProgressState state;
  state.stage = job.stage.empty() ? job.state : job.stage;
  state.fraction = job.fraction;
  state.samples_done = job.samples_done;
  state.samples_target = job.stage.empty() ? job.samples_target : 0.0;
  state.elapsed_seconds = job.elapsed_seconds;
  state.remaining_seconds = job.remaining_seconds;
  state.rays_per_second = job.rays_per_second;
  return state;
}

ExitCode exit_code_for_status(int status) {
  if (status == 404) return ExitCode::kNotFound;
  if (status == 429 || status == 503) return ExitCode::kBusy;
  return ExitCode::kRefused;
}

ExitCode exit_code_for_state(const std::string& state) {
  if (state == "failed") return ExitCode::kJobFailed;
  if (state == "cancelled") return ExitCode::kJobCancelled;
  return ExitCode::kOk;
}

std::optional<Remote> Remote::open(const CliOptions& options) {
  auto address = parse_server_url(options.server);
  if (address) return Remote(std::move(*address));
  std::cerr << "raykiln: --server: " << address.error().message << '\n';
  return std::nullopt;
}

std::string clean(const std::string& text) {
  std::string out;
  for (const char c : text) out.push_back(static_cast<unsigned char>(c) < 0x20 || c == 0x7F ? '?' : c);
  return out;
}

void Remote::warn(const std::string& message) {
  if (warned_.insert(message).second) std::cerr << "warning: " << clean(message) << '\n';
}

ExitCode Remote::fail(ExitCode code, const std::string& message) {
  std::cerr << "raykiln: " << message << '\n';
  failure_ = code;
  return code;
}

std::optional<ClientResponse> Remote::check(Result<ClientResponse> response) {
  if (!response) {
    const Error& error = response.error();
    const bool is_server = error.code == "no_server";
    fail(is_server ? ExitCode::kNoServer : ExitCode::kFailure,
         (is_server ? "no answer from the server: " : "") + error.message +
             (error.where.empty() ? "" : " (" + error.where + ')'));
    return std::nullopt;
  }
  if (response->status >= 200 && response->status < 300) return std::move(*response);
  fail(exit_code_for_status(response->status), problem_text(response->body));
  return std::nullopt;
}

std::optional<ClientResponse> Remote::ask(const std::string& method, const std::string& target,
                                          const ClientHeaders& headers, const std::string& body) {
  return check(HttpClient(address_).request(method, target, headers, body));
}

std::optional<JobView> Remote::follow(const std::string& job, ProgressLine& line,
                                      std::string* last_json) {
  std::optional<JobView> newest;
  for (int attempt = 0; attempt < kMaxReconnects; ++attempt) {
    if (attempt > 0) std::this_thread::sleep_for(std::chrono::seconds(1));
    SseReader reader;
    bool bad = false;
    const auto take = [&](std::string_view bytes) {
      const auto events = reader.feed(bytes);
      bad = !events.has_value();
      if (bad) return false;
      for (const auto& event : *events) {
        auto view = parse_job_view(event.data);
        if (!view) continue;
        attempt = 0;
        line.show(progress_of(*view));
        if (last_json != nullptr) *last_json = event.data;
        newest = std::move(view);
      }
      return !newest || !is_final_state(newest->state);
    };
    auto response = HttpClient(address_).stream("/v1/jobs/" + job + "/events", {}, take);
    if (newest && is_final_state(newest->state)) return newest;
    if (response && response->status != 200) {
      const bool temporary = response->status == 503;
      if (!temporary) {
        line.finish();
        static_cast<void>(check(std::move(response)));  // prints, and sets the failure
        return std::nullopt;
      }
    }
    if (!response && !newest) {  // it was never there
      line.finish();
      static_cast<void>(check(std::move(response)));
      return std::nullopt;
    }
    if (bad) break;
  }
  line.finish();
  fail(ExitCode::kNoServer, "the event stream was lost");
  return std::nullopt;
}

ExitCode fetch_pictures(Remote& remote, const CliOptions& options, const std::string& job) {
  for (const auto& output : options.outputs) {
    std::string target = "/v1/jobs/" + job + "/image?format=";
    target += output.extension() == ".exr" ? "exr" : "png";
    if (output.extension() == ".exr" && options.picture.half) target += "&type=half";
    if (output.extension() == ".png" && options.picture.exposure_stops != 0.0) {
      target += "&exposure=" + std::to_string(options.picture.exposure_stops);
    }
    const auto response = remote.ask("GET", target);
    if (!response) return remote.failure();
    const auto* clamped = response->header("raykiln-clamped-values");
    if (clamped != nullptr && *clamped != "0") say_clamped(output, *clamped);
    if (const auto error = write_whole_file(output, response->body)) {
      return remote.fail(ExitCode::kFailure, *error);
    }
  }
  return ExitCode::kOk;
}

}  // namespace raykiln::server
