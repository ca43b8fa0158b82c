// The two ways to run a batch.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>

#include "batch_result.hpp"
#include "raykiln/app/cli.hpp"

namespace raykiln::server {

struct BatchRun {
  const CliOptions& options;
  std::filesystem::path folder;  ///< where the pictures of the report go
  int threads = 0;
  bool quiet = false;
};

/// Fills the result; anything but kOk is a failure of this machine or, on a server, of the connection.
[[nodiscard]] ExitCode run_batch_here(const BatchRun& run, BatchResult& result);

}  // namespace raykiln::server
