#include "await.hpp"
#include "query.hpp"
#include "raykiln/api/api.hpp"

namespace raykiln::server {
namespace {

constexpr std::size_t kImageBytes = 256U << 20U;
constexpr std::size_t kImageEntries = 64;
constexpr int kMaxEncoders = 2;

Response health(const char* status, const std::string& version) {
  return json_response(200, std::string(R"({"status":")") + status + R"(","version":")" + version + "\"}");
}

}  // namespace

Api::Api(const Config& config, Parts parts)
    : config_(config),
      parts_(std::move(parts)),
      images_(kImageBytes, kImageEntries, kMaxEncoders),
      uploads_(std::make_shared<std::atomic<int>>(0)) {}

Answer Api::livez(const Request& request) {
  if (auto problem = check_query(request, {})) return to_response(*problem);
  return health("ok", config_.version);
}

Answer Api::readyz(const Request& request) {
  if (auto problem = check_query(request, {})) return to_response(*problem);
  const auto status = await<SchedulerStatus>([&](auto reply) { parts_.scheduler.status(std::move(reply)); });
  if (!status) return to_response(problem_of(status.error()));
  if (!status->accepting) {
    Problem problem{503, "shutting_down", "the server is stopping"};
    problem.retry_after_s = 5;
    return to_response(problem);
  }
  return health("ready", config_.version);
}

Answer Api::metrics_text(const Request&) {
  Response response;
  response.content_type = "text/plain; version=0.0.4; charset=utf-8";
  response.headers.emplace_back("Cache-Control", "no-store");
  response.body = std::make_shared<const std::string>(parts_.metrics.prometheus_text());
  return response;
}

}  // namespace raykiln::server
