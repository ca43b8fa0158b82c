// One function per operation of proto/openapi.yaml. Knows JSON and jobs, no sockets.
#pragma once

#include <atomic>
#include <memory>
#include <string>

#include "raykiln/api/encoded_cache.hpp"
#include "raykiln/api/message.hpp"
#include "raykiln/base/config.hpp"
#include "raykiln/base/log.hpp"
#include "raykiln/base/metrics.hpp"
#include "raykiln/scheduler/scheduler.hpp"
#include "raykiln/store/store.hpp"

namespace raykiln::server {

/// Safe to use from any thread. Calls block until the scheduler has answered, which it does without
/// waiting for anything but an import (`Upload::finish`).
class Api {
 public:
  struct Parts {
    Scheduler& scheduler;
    Store& store;
    MetricsRegistry& metrics;
    Log log;
  };
  Api(const Config& config, Parts parts);

  [[nodiscard]] UploadStart create_scene(const Request& request);
  [[nodiscard]] UploadStart put_scene(const Request& request);
  [[nodiscard]] Answer list_scenes(const Request& request);
  [[nodiscard]] Answer get_scene(const Request& request);
  [[nodiscard]] Answer delete_scene(const Request& request);
  [[nodiscard]] Answer prepare_scene(const Request& request);

  [[nodiscard]] Answer create_job(const Request& request);
  [[nodiscard]] Answer extend_job(const Request& request);
  [[nodiscard]] Answer create_quote(const Request& request);
  [[nodiscard]] Answer get_quote(const Request& request);
  [[nodiscard]] Answer list_jobs(const Request& request);
  [[nodiscard]] Answer get_job(const Request& request);
  [[nodiscard]] Answer get_accuracy(const Request& request);
  [[nodiscard]] Answer cancel_job(const Request& request);
  [[nodiscard]] Answer watch_job(const Request& request);
  [[nodiscard]] Answer get_image(const Request& request);
  [[nodiscard]] Answer replay_sample(const Request& request);

  [[nodiscard]] Answer livez(const Request& request);
  [[nodiscard]] Answer readyz(const Request& request);
  [[nodiscard]] Answer metrics_text(const Request& request);

 private:
  [[nodiscard]] UploadStart start_upload(const Request& request, std::string expected_digest);

  Config config_;
  Parts parts_;
  EncodedCache images_;
  std::shared_ptr<std::atomic<int>> uploads_;  ///< in progress
  std::atomic<int> replays_{0};                 ///< in progress
};

}  // namespace raykiln::server
