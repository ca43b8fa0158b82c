// The two ways to run a batch.
#pragma once

#include <filesystem>

#include "batch_result.hpp"
#include "raykiln/app/cli.hpp"

namespace raykiln::server {

struct BatchRun {
  const CliOptions& options;
  std::filesystem::path folder;  ///< where the pictures of the report go
  int threads = 0;
  bool quiet = false;
};

/// Fills the result; anything but kOk is a failure of this machine.
[[nodiscard]] ExitCode run_batch_here(const BatchRun& run, BatchResult& result);

/// The same by the daemon of the options; or of the connection. `waited`: false when the batch was sent
/// and not to be waited for.
[[nodiscard]] ExitCode run_batch_on_server(const BatchRun& run, BatchResult& result, bool& waited);

}  // namespace raykiln::server
