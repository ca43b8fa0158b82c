// Every setting and limit of the daemon with its default.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

namespace raykiln::server {

inline constexpr std::uint64_t kMiB = std::uint64_t{1} << 20;
inline constexpr std::uint64_t kGiB = std::uint64_t{1} << 30;

/// What a job may ask for.
struct JobLimits {
  int max_side = 16'384;                        ///< pixels
  std::uint64_t max_samples = 1'048'576;        ///< a pixel
  double max_seconds = 604'800.0;               ///< of a time stop
  int max_depth = 1'024;                        ///< reflections after the first hit
  int max_branches = 16;
  std::uint64_t max_branch_paths = 65'536;      ///< branches ^ max_depth, a sample
  int max_tile = 4'096;                         ///< pixels a side
  std::uint64_t max_tiles = 1'000'000;          ///< of one film
  int max_priority = 100;                       ///< 1 .. this
  double max_tree_references = 64.0;            ///< a triangle, of the tree
  std::uint64_t max_tree_bytes = (std::uint64_t{1} << 53) - 1;  ///< that a job may name; exact as a JSON number
  std::size_t max_name_bytes = 200;
};

/// What an upload may be.
struct UploadLimits {
  std::uint64_t max_upload_bytes = 2 * kGiB;     ///< of one upload
  std::uint64_t max_staging_bytes = 4 * kGiB;    ///< of all uploads in progress
  std::size_t max_files = 256;                   ///< files of a multipart upload
  std::size_t max_entries = 10'000;              ///< entries of an archive
  std::uint64_t max_unpacked_bytes = 8 * kGiB;   ///< of all files of an archive
  double max_unpack_ratio = 1'000.0;             ///< unpacked / packed, above 16 MiB unpacked
  std::size_t max_name_bytes = 255;              ///< of one file name
};

struct SchedulerSettings {
  std::size_t max_queued_jobs = 100;
  std::size_t max_active_jobs = 8;               ///< preparing or rendering at once
  std::uint64_t max_film_bytes = 4 * kGiB;       ///< of all active jobs together
  std::uint64_t max_kept_film_bytes = kGiB;      ///< films of completed jobs kept in memory, to go on from
  int max_attempts = 3;                          ///< of one work item
  double task_seconds_low = 0.005;               ///< a task is meant to last between these
  double task_seconds_target = 0.025;
  double task_seconds_high = 0.050;
  std::chrono::milliseconds publish_interval{150};  ///< least time between progress revisions
  double look_share = 0.01;                      ///< of the render time, to look at running pictures; 0: never
  std::size_t max_cached_images = 4;             ///< resolved pictures kept for the API
  std::size_t max_kept_jobs = 10'000;            ///< finished jobs kept in the store
};

struct WorkerSettings {
  int threads = 0;                               ///< 0: one a processor
  int niceness = 5;                              ///< of the worker threads, 0 .. 19
  int preparing_threads = 2;                     ///< imports and builds at once
  std::uint64_t scene_cache_bytes = 4 * kGiB;    ///< scenes and trees kept in memory
  std::uint64_t wide_tree_bytes = kGiB;          ///< of building a tree of more references than by default
  std::size_t max_pending_imports = 16;          ///< uploads waiting for validation
};

struct StoreSettings {
  std::filesystem::path directory = "raykiln-store";
  std::uint64_t max_bytes = 64 * kGiB;           ///< scenes and images together
};

struct HttpSettings {
  std::string address = "127.0.0.1";
  std::uint16_t port = 8080;                     ///< 0: any free one
  int threads = 2;
  std::size_t max_connections = 512;
  std::size_t max_json_bytes = 256 * 1024;       ///< of a JSON request body
  std::size_t max_watchers = 256;                ///< event streams at once
  std::chrono::seconds request_timeout{30};      ///< without progress
  std::chrono::seconds heartbeat{10};            ///< of an event stream
};

struct Config {
  JobLimits jobs;
  UploadLimits uploads;
  SchedulerSettings scheduler;
  WorkerSettings workers;
  StoreSettings store;
  HttpSettings http;
  std::chrono::seconds drain{10};                ///< time for work in progress on SIGTERM
  std::string version = "0.1.0";
  std::string engine;                            ///< equal for programs that make equal pictures
};

}  // namespace raykiln::server
