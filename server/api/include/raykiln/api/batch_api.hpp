// The operations of batches; see api.hpp.
#pragma once

#include "raykiln/api/encoded_cache.hpp"
#include "raykiln/api/message.hpp"
#include "raykiln/base/config.hpp"
#include "raykiln/batches/batch_runner.hpp"
#include "raykiln/store/store.hpp"

namespace raykiln::server {

/// Safe to use from any thread; calls wait for the runner's answer. The JSON of a batch is written once a revision
/// for all who ask and watch, and kept in at most 8 MiB.
class BatchApi {
 public:
  BatchApi(const Config& config, BatchRunner& batches, Store& store);

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
  std::shared_ptr<EncodedCache> texts_;  ///< shared with the event streams
};

}  // namespace raykiln::server
