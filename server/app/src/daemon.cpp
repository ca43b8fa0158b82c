#include "raykiln/app/daemon.hpp"

#include <fstream>
#include <iostream>
#include <thread>

#include "raykiln/api/api.hpp"
#include "raykiln/api/batch_api.hpp"
#include "raykiln/app/embedded_files.hpp"
#include "raykiln/http/routes.hpp"
#include "raykiln/http/server.hpp"
#include "raykiln/image/encode.hpp"
#include "raykiln/scheduler/scheduler.hpp"
#include "raykiln/store/sqlite_store.hpp"
#include "raykiln/workers/local_pool.hpp"
#include "raykiln/workers/scene_cache.hpp"
#include "raykiln/workers/scene_intake.hpp"
#include "signals.hpp"

namespace raykiln::server {
namespace {

enum DaemonExit : int { kStopped = 0, kFailed = 1, kNoStore = 3, kNoAddress = 4 };

constexpr auto kHttpGrace = std::chrono::seconds(2);

constexpr std::string_view kNoPage =
    "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><title>raykiln</title>"
    "<h1>raykiln is running</h1><p>This daemon was built without its web page. Build it with "
    "<code>npm ci &amp;&amp; npm run build</code> in <code>web/</code> and build the daemon again, or "
    "give <code>--web-dir</code>. The interface is described in "
    "<a href=\"/openapi.yaml\">openapi.yaml</a>.</p></html>\n";

bool load_files(const DaemonOptions& options, StaticFiles& files) {
  files.add("index.html", std::string(kNoPage));
  for (const auto& file : embedded_files()) {
    files.add(std::string(file.path), std::string(file.bytes, file.bytes + file.size));
  }
  if (options.web_directory.empty()) return true;
  return files.add_directory(options.web_directory);
}

ServerSettings server_settings(const DaemonOptions& options) {
  const HttpSettings& http = options.config.http;
  ServerSettings settings;
  settings.address = http.address;
  settings.port = http.port;
  settings.max_connections = http.max_connections;
  settings.body_timeout = http.request_timeout;
  settings.write_timeout = http.request_timeout;
  settings.sse.heartbeat = http.heartbeat;
  settings.hosts.names = options.allowed_hosts;
  return settings;
}

/// Clients see the file whole or not at all.
bool write_ready_file(const std::filesystem::path& path, const std::string& url) {
  if (path.empty()) return true;
  const std::filesystem::path part = path.string() + ".part";
  std::ofstream(part) << url << '\n';
  std::error_code error;
  std::filesystem::rename(part, path, error);
  return !error;
}

std::string url_of(const HttpSettings& http, std::uint16_t port) {
  const bool is_v6 = http.address.find(':') != std::string::npos;
  return "http://" + (is_v6 ? '[' + http.address + ']' : http.address) + ':' + std::to_string(port);
}

/// Everything that lives as long as the daemon serves, in the order in which it depends.
class Daemon {
 public:
  Daemon(const DaemonOptions& options, Store& store, BatchRecords& records, const StaticFiles& files, Log log)
      : options_(options),
        config_(options.config),
        log_(std::move(log)),
        pool_(config_.workers),
        intake_(make_scene_intake(config_.uploads, [&store] { return store.scratch_directory(); })),
        cache_(config_.workers,
               {store, *intake_, pool_, clock_, metrics_, log_.channel("workers"), {}}),
        scheduler_(config_, {store, pool_, *intake_, cache_, clock_, metrics_, log_.channel("scheduler")}),
        api_(config_, {scheduler_, store, metrics_, log_.channel("api")}),
        batches_({scheduler_, records, clock_, log_.channel("batches")},
                 {.watchers = options.max_batch_watchers}),
        batch_api_(config_, batches_, store),
        routes_(make_routes(api_, batch_api_, files, config_.http.max_json_bytes)),
        server_(server_settings(options), {routes_, clock_, metrics_, log_.channel("http")}) {}

  int serve() {
    const auto port = server_.listen();
    if (!port) {
      std::cerr << "raykilnd: cannot listen on " << port.error().where << ": " << port.error().message
                << '\n';
      return kNoAddress;
    }
    std::jthread impatient;  // joined after the server has ended
    const std::jthread io([this] { server_.run(); });
    const std::string url = url_of(config_.http, *port);
    std::cout << "raykilnd " << config_.version << " ready at " << url << std::endl;
    const bool told = write_ready_file(options_.ready_file, url);
    if (!told) std::cerr << "raykilnd: cannot write " << options_.ready_file << '\n';
    if (told) log_.info("stopping", {{"signal", wait_for_stop_signal()}});
    impatient = std::jthread([](std::stop_token token) { exit_on_second_signal(token); });
    stop();
    return told ? kStopped : kFailed;
  }

 private:
  void stop() {
    // Clients see the end of their jobs, or that the server is stopping, while jobs drain.
    batches_.stop();
    scheduler_.shutdown(config_.drain);
    server_.stop(kHttpGrace);
  }

  const DaemonOptions& options_;
  const Config& config_;
  Log log_;
  SystemClock clock_;
  MetricsRegistry metrics_;
  LocalPool pool_;
  std::unique_ptr<SceneIntake> intake_;
  SceneCache cache_;
  Scheduler scheduler_;
  Api api_;
  BatchRunner batches_;
  BatchApi batch_api_;
  Router routes_;
  Server server_;
};

}  // namespace

int run_daemon(const DaemonOptions& options) {
  block_stop_signals();
  render::set_image_library_threads(1);
  const Log log = Log::to_stderr(options.log_level).channel("app");
  StaticFiles files;
  if (!load_files(options, files)) {
    std::cerr << "raykilnd: cannot read the page in " << options.web_directory << '\n';
    return kFailed;
  }
  auto store = open_sqlite_store(options.config.store, options.config.uploads, log.channel("store"));
  if (!store) {
    std::cerr << "raykilnd: cannot use the store in " << options.config.store.directory << ": "
              << store.error().message << '\n';
    return kNoStore;
  }
  auto records = BatchRecords::open(options.config.store);
  if (!records) {
    std::cerr << "raykilnd: cannot use the store in " << options.config.store.directory << ": "
              << records.error().message << '\n';
    return kNoStore;
  }
  Daemon daemon(options, **store, **records, files, log);
  return daemon.serve();
}

}  // namespace raykiln::server
