#include <CLI/CLI.hpp>
#include <charconv>
#include <iostream>
#include <map>

#include "raykiln/app/daemon.hpp"
#include "raykiln/app/embedded_files.hpp"
#include "raykiln/http/origin.hpp"

namespace raykiln::server {
namespace {

constexpr const char* kFooter =
    "Signals: SIGTERM or SIGINT stops taking work, lets running jobs work on for the drain time and\n"
    "saves; jobs that have not ended run again at the next start. A second one ends at once.\n"
    "Exit codes: 0 stopped by a signal, 1 failure, 2 wrong command line, 3 the store cannot be used,\n"
    "4 the address cannot be listened on.";

/// "127.0.0.1:8080", "[::1]:0", "8080".
bool read_listen(const std::string& text, HttpSettings& http) {
  std::string port = text;
  const auto colon = text.rfind(':');
  if (colon != std::string::npos) {
    http.address = text.substr(0, colon);
    port = text.substr(colon + 1);
    if (http.address.starts_with('[') && http.address.ends_with(']')) {
      http.address = http.address.substr(1, http.address.size() - 2);
    }
  }
  if (http.address == "localhost") http.address = "127.0.0.1";
  const auto* end = port.data() + port.size();
  const auto [stop, error] = std::from_chars(port.data(), end, http.port);
  return error == std::errc{} && stop == end;
}

}  // namespace

ParsedDaemon parse_daemon_options(int argc, const char* const* argv) {
  ParsedDaemon parsed;
  Config& config = parsed.options.config;
  config.version = RAYKILN_VERSION;
  config.engine = engine_digest();
  std::string listen = "127.0.0.1:8080";
  bool allow_remote = false;
  int drain_seconds = static_cast<int>(config.drain.count());

  CLI::App app("raykilnd: render server with an HTTP interface");
  app.footer(kFooter);
  app.set_version_flag("--version", std::string("raykilnd ") + RAYKILN_VERSION);
  app.add_option("--listen", listen, "address:port; port 0 takes any free one")->capture_default_str();
  app.add_flag("--allow-remote", allow_remote,
               "listen on an address that other machines can reach; there is no authentication");
  app.add_option("--allow-host", parsed.options.allowed_hosts,
                 "name by which clients may call this server, beside localhost and IP addresses");
  app.add_option("--store", config.store.directory, "folder of scenes, jobs and pictures")
      ->capture_default_str();
  app.add_option("--workers", config.workers.threads, "render threads; 0: one a processor")
      ->check(CLI::Range(0, 1024));
  app.add_option("--cache-bytes", config.workers.scene_cache_bytes, "scenes and trees kept in memory")
      ->transform(CLI::AsSizeValue(false));
  app.add_option("--wide-tree-bytes", config.workers.wide_tree_bytes,
                 "that building a tree may hold which has more references a triangle than by default;\n"
                 "what a default tree may need is always allowed")
      ->transform(CLI::AsSizeValue(false) & CLI::Range(std::uint64_t{1}, config.jobs.max_tree_bytes));
  app.add_option("--store-bytes", config.store.max_bytes, "most that the store may hold")
      ->transform(CLI::AsSizeValue(false));
  app.add_option("--film-bytes", config.scheduler.max_film_bytes, "pictures of all running jobs together")
      ->transform(CLI::AsSizeValue(false));
  app.add_option("--max-upload-bytes", config.uploads.max_upload_bytes, "of one upload")
      ->transform(CLI::AsSizeValue(false));
  app.add_option("--max-queued", config.scheduler.max_queued_jobs, "jobs that may wait")
      ->capture_default_str();
  app.add_option("--max-active", config.scheduler.max_active_jobs, "jobs that run at once")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--look-share", config.scheduler.look_share,
                 "part of the render time that may go into judging the error of running pictures; "
                 "0: only at error targets and in the end")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  app.add_option("--max-connections", config.http.max_connections)
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  app.add_option("--max-watchers", config.http.max_watchers, "event streams of jobs at once")
      ->capture_default_str();
  app.add_option("--max-batch-watchers", parsed.options.max_batch_watchers, "event streams of batches at once")
      ->capture_default_str();
  app.add_option("--drain-seconds", drain_seconds, "time for running jobs after a signal")
      ->check(CLI::Range(0, 86400))
      ->capture_default_str();
  app.add_option("--web-dir", parsed.options.web_directory, "serve the page from this folder");
  app.add_option("--ready-file", parsed.options.ready_file, "write the URL here when ready");
  const std::map<std::string, LogLevel> levels{{"debug", LogLevel::kDebug}, {"info", LogLevel::kInfo},
                                               {"warn", LogLevel::kWarn},   {"error", LogLevel::kError},
                                               {"off", LogLevel::kOff}};
  app.add_option("--log-level", parsed.options.log_level, "debug, info, warn, error, off")
      ->transform(CLI::CheckedTransformer(levels, CLI::ignore_case).description(""));

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    parsed.exit_code = app.exit(error) == 0 ? 0 : 2;
    return parsed;
  }
  config.drain = std::chrono::seconds(drain_seconds);
  if (!read_listen(listen, config.http)) {
    std::cerr << "--listen wants address:port\n";
    parsed.exit_code = 2;
  } else if (!allow_remote && !is_loopback(config.http.address)) {
    std::cerr << "raykilnd has no authentication: to listen on " << config.http.address
              << ", which other machines may reach, add --allow-remote\n";
    parsed.exit_code = 2;
  }
  return parsed;
}

}  // namespace raykiln::server
