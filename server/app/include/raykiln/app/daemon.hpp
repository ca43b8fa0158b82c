// The daemon: objects built, connected, run and stopped.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "raykiln/base/config.hpp"
#include "raykiln/base/log.hpp"

namespace raykiln::server {

struct DaemonOptions {
  Config config;
  std::vector<std::string> allowed_hosts;  ///< names beside localhost and IP addresses
  std::filesystem::path web_directory;     ///< empty: the embedded page
  std::filesystem::path ready_file;        ///< empty: none; gets the URL when the daemon is ready
  std::size_t max_batch_watchers = 64;     ///< event streams of batches at once
  LogLevel log_level = LogLevel::kInfo;
};

/// What the command line came to: options, or an exit code after help, version or an error.
struct ParsedDaemon {
  DaemonOptions options;
  int exit_code = -1;  ///< -1: run
};

[[nodiscard]] ParsedDaemon parse_daemon_options(int argc, const char* const* argv);

/// Exit codes of the daemon: 0 stopped by a signal, 1 failure, 2 wrong command line, 3 the store cannot
/// be used (another daemon has it, for example), 4 the address cannot be listened on.
[[nodiscard]] int run_daemon(const DaemonOptions& options);

}  // namespace raykiln::server
