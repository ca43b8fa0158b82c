// A whole server core on a directory, without HTTP.
#pragma once

#include <chrono>
#include <future>
#include <memory>
#include <string>
#include <thread>

#include "raykiln/scheduler/scheduler.hpp"
#include "raykiln/store/sqlite_store.hpp"
#include "raykiln/workers/local_pool.hpp"
#include "support/fake_intake.hpp"

namespace raykiln::tests {

using namespace std::chrono_literals;

/// Waits for the one answer of an asynchronous call.
template <class T, class Call>
server::Result<T> answer_of(const Call& call) {
  auto promise = std::make_shared<std::promise<server::Result<T>>>();
  auto future = promise->get_future();
  call([promise](server::Result<T> result) { promise->set_value(std::move(result)); });
  if (future.wait_for(60s) != std::future_status::ready) throw std::runtime_error("no answer");
  return future.get();
}

class ServerRig {
 public:
  explicit ServerRig(const std::filesystem::path& directory, int threads = 2,
                     server::TreeBuilder build = {}, server::Config base = {})
      : config(std::move(base)) {
    config.store.directory = directory;
    config.workers.threads = threads;
    auto opened = server::open_sqlite_store(config.store, config.uploads, server::Log());
    if (!opened) throw std::runtime_error(opened.error().message);
    store = std::move(*opened);
    pool = std::make_unique<server::LocalPool>(config.workers);
    cache = std::make_unique<server::SceneCache>(
        config.workers, server::SceneCache::Parts{*store, intake, *pool, clock, metrics,
                                                  server::Log(), std::move(build)});
    start();
  }
  ~ServerRig() { scheduler.reset(); }

  void start() {
    scheduler = std::make_unique<server::Scheduler>(
        config, server::Scheduler::Parts{*store, executor ? *executor : *pool, intake, *cache,
                                         clock, metrics, server::Log(), judged_at_once_px});
  }

  server::Result<server::AddedScene> add_scene(const std::string& bytes,
                                               const std::string& expected = "") {
    auto upload = store->begin_upload(server::SceneKind::kGlb);
    if (!upload) return upload.error();
    if (auto s = (*upload)->begin_file("scene.glb"); !s) return s.error();
    if (auto s = (*upload)->append(std::as_bytes(std::span(bytes))); !s) return s.error();
    if (auto s = (*upload)->finish(); !s) return s.error();
    return answer_of<server::AddedScene>([&](auto reply) {
      scheduler->add_scene(std::move(*upload), {"test", expected}, reply);
    });
  }
  server::Result<server::SubmittedJob> submit(const server::JobRequest& request,
                                              const std::string& key = "") {
    return answer_of<server::SubmittedJob>(
        [&](auto reply) { scheduler->submit({request, key}, reply); });
  }
  server::Result<server::JobSnapshot> get(const std::string& id) {
    return answer_of<server::JobSnapshot>([&](auto reply) { scheduler->get(id, reply); });
  }
  server::Result<server::JobSnapshot> cancel(const std::string& id) {
    return answer_of<server::JobSnapshot>([&](auto reply) { scheduler->cancel(id, reply); });
  }
  server::Result<server::JobImagePtr> image(const std::string& id) {
    return answer_of<server::JobImagePtr>(
        [&](auto reply) { scheduler->image(id, "beauty", reply); });
  }

  /// Follows a job through its events until `until` holds; every snapshot seen goes to `seen`.
  template <class Until>
  server::JobSnapshot follow(const std::string& id, const Until& until,
                             std::vector<server::JobSnapshot>* seen = nullptr) {
    struct Bell {
      std::mutex mutex;
      std::condition_variable rung;
      bool ringing = false;
    };
    auto bell = std::make_shared<Bell>();
    auto subscription = answer_of<std::unique_ptr<server::Subscription>>([&](auto reply) {
      auto shared = std::make_shared<decltype(reply)>(reply);
      scheduler->watch(
          id,
          [bell] {
            const std::scoped_lock lock(bell->mutex);
            bell->ringing = true;
            bell->rung.notify_one();
          },
          [shared](auto result) { (*shared)(std::move(result)); });
    });
    if (!subscription) throw std::runtime_error(subscription.error().message);
    while (true) {
      while (auto snapshot = (*subscription)->take()) {
        if (seen != nullptr) seen->push_back(*snapshot);
        if (until(*snapshot)) return *snapshot;
      }
      std::unique_lock lock(bell->mutex);
      if (!bell->rung.wait_for(lock, 60s, [&] { return bell->ringing; })) {
        throw std::runtime_error("no event");
      }
      bell->ringing = false;
    }
  }
  server::JobSnapshot wait_final(const std::string& id,
                                 std::vector<server::JobSnapshot>* seen = nullptr) {
    return follow(id, [](const auto& s) { return server::is_final(s.state); }, seen);
  }

  server::Config config;
  server::SystemClock clock;
  server::MetricsRegistry metrics;
  FakeIntake intake;
  std::unique_ptr<server::Store> store;
  std::unique_ptr<server::LocalPool> pool;
  server::Executor* executor = nullptr;
  int judged_at_once_px = 65'536;
  std::unique_ptr<server::SceneCache> cache;
  std::unique_ptr<server::Scheduler> scheduler;
};

inline server::JobRequest small_job(const std::string& scene, std::uint64_t samples = 8) {
  server::JobRequest request;
  request.scene = scene;
  request.width = 96;
  request.height = 64;
  request.stop.samples = samples;
  request.tile = 32;
  request.max_depth = 3;
  return request;
}

}  // namespace raykiln::tests
