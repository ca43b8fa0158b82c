// What a batch file asks for, spread out: one item a picture.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "raykiln/app/comparison.hpp"
#include "raykiln/base/result.hpp"
#include "raykiln/jobs/job_request.hpp"
#include "value.hpp"

namespace raykiln::server {

struct PlannedPicture {
  std::string name;               ///< unique in the batch; letters, digits, '.', '_', '-': fit for a file name
  std::filesystem::path scene;
  std::filesystem::path reference;  ///< empty: none
  JobRequest request;             ///< the scene's id is filled in when its files have been read
};

struct BatchPlan {
  std::string name;
  int priority = 10;              ///< on a server, as the next two
  int max_active = 4;
  bool reuse = true;              ///< take the pictures of equal jobs that have completed
  bool fail_fast = false;
  double false_alarms = 0.01;     ///< of the whole batch: shared by the pictures that have a reference
  ComparisonSettings comparison;  ///< its false_alarms is each picture's part
  std::vector<PlannedPicture> pictures;
};

/// Fields are described in proto/batch.schema.json. Paths are relative to `folder`. Errors: kInvalid
/// "invalid_file" with the place in `where`.
[[nodiscard]] Result<BatchPlan> plan_batch(const Value& file, const std::filesystem::path& folder,
                                           const JobLimits& limits);

/// Reads and plans. kNotFound "file_missing" too.
[[nodiscard]] Result<BatchPlan> read_batch_file(const std::filesystem::path& path, const JobLimits& limits);

}  // namespace raykiln::server
