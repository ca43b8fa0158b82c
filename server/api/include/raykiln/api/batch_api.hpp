// The operations of batches; see api.hpp.
#pragma once

#include "raykiln/api/message.hpp"
#include "raykiln/base/config.hpp"
#include "raykiln/batches/batch_runner.hpp"
#include "raykiln/store/store.hpp"

namespace raykiln::server {

/// Safe to use from any thread; calls wait for the runner's answer.
class BatchApi {
 public:
  BatchApi(const Config& config, BatchRunner& batches, Store& store)
      : limits_(config.jobs), batches_(batches), store_(store) {}

  [[nodiscard]] Answer create_batch(const Request& request);
  [[nodiscard]] Answer list_batches(const Request& request);
  [[nodiscard]] Answer get_batch(const Request& request);
  [[nodiscard]] Answer cancel_batch(const Request& request);
  [[nodiscard]] Answer rerun_batch(const Request& request);
  [[nodiscard]] Answer watch_batch(const Request& request);
  [[nodiscard]] Answer missing_scenes(const Request& request);

 private:
  JobLimits limits_;
  BatchRunner& batches_;
  Store& store_;
};

}  // namespace raykiln::server
