// Scenes, job records and final images that survive the process.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "raykiln/base/clock.hpp"
#include "raykiln/base/result.hpp"
#include "raykiln/jobs/job_state.hpp"

namespace raykiln::server {

enum class SceneKind { kZip, kGlb, kFiles };
[[nodiscard]] std::string_view name(SceneKind kind);  ///< "zip", "glb", "files"
[[nodiscard]] std::optional<SceneKind> scene_kind_named(std::string_view name);

struct SceneFileEntry {
  std::string name;    ///< as uploaded; never used as a path on this machine
  std::uint64_t bytes = 0;
  std::string sha256;  ///< 64 hexadecimal digits
};

struct SceneRecord {
  std::string id;  ///< SHA-256 of the bytes, or of the sorted list of files
  SceneKind kind = SceneKind::kZip;
  std::string name;  ///< free text for people
  std::uint64_t bytes = 0;
  std::vector<SceneFileEntry> files;  ///< one for zip and glb
  WallTime created{};
  std::string report;  ///< what the import found; opaque here
};

/// Where the bytes of an uploaded file lie now.
struct BlobFile {
  std::string name;  ///< as uploaded
  std::filesystem::path path;
  std::uint64_t bytes = 0;
};

/// An upload in progress, on disk, bounded. Destroying it uncommitted removes every trace.
/// One thread at a time; different uploads are independent.
class SceneUpload {
 public:
  virtual ~SceneUpload() = default;

  /// Starts the next file (zip and glb have exactly one). Errors: unsafe_name (also a name that was
  /// there before), payload_too_large (too many files).
  virtual Status begin_file(const std::string& name) = 0;
  /// Appends to the current file. Errors: payload_too_large, too_many_uploads (no room for
  /// staging now), storage_full, and internal ones of the disk. After an error the upload can only be destroyed.
  virtual Status append(std::span<const std::byte> bytes) = 0;
  /// Ends the last file. Errors: scene_empty (no file). To be called once, before the rest.
  virtual Status finish() = 0;

  [[nodiscard]] virtual SceneKind kind() const = 0;
  [[nodiscard]] virtual std::uint64_t bytes() const = 0;
  /// After finish(): id that the scene will have, made as proto/openapi.yaml says.
  [[nodiscard]] virtual std::string id() const = 0;
  [[nodiscard]] virtual std::vector<SceneFileEntry> entries() const = 0;
  [[nodiscard]] virtual std::vector<BlobFile> files() const = 0;
};

/// A layer that was asked for.
struct StoredLayer {
  std::string name;
  std::vector<float> values;  ///< 1 to 4 a pixel
};

/// A linear picture as it was when the job ended. RGB, 3 floats a pixel, row 0 at the top.
struct StoredImage {
  int width = 0, height = 0;
  std::vector<float> rgb;
  /// Standard errors (3 a pixel), samples and worker seconds (1 a pixel each); none or all of them.
  std::vector<float> error{}, samples{}, seconds{};
  std::vector<StoredLayer> layers{};  ///< only with those
};

struct JobRecord {
  std::string id;
  JobState state = JobState::kQueued;
  std::uint64_t revision = 0;
  std::string scene;            ///< scene id
  WallTime created{}, updated{};
  std::string idempotency_key;  ///< empty: none
  std::string request_digest;
  std::string content;          ///< opaque here
  std::string result_digest{};  ///< of the picture, see jobs; empty: not to be found by it
  std::uint64_t sequence = 0;   ///< set by the store: order of creation, for paging
};

struct JobQuery {
  std::vector<JobState> states{};  ///< empty: any
  std::string scene{};             ///< empty: any
  std::uint64_t before = 0;        ///< only smaller sequences; 0: from the newest
  std::size_t limit = 50;
};

/// Safe to use from any thread. Every change is atomic and on disk when the call returns: a process
/// killed at any moment leaves either all of it or nothing. Failures of the disk are
/// ErrorKind::kInternal with code "internal"; a full store is kStorageFull, "storage_full".
class Store {
 public:
  virtual ~Store() = default;

  virtual Result<std::unique_ptr<SceneUpload>> begin_upload(SceneKind kind) = 0;

  /// Makes a finished upload a scene. False: a scene of this id is there already, and stays as it is.
  virtual Result<bool> commit_scene(std::unique_ptr<SceneUpload> upload, const std::string& name,
                                    WallTime created, const std::string& report) = 0;
  virtual Result<SceneRecord> scene(const std::string& id) = 0;  ///< "scene_not_found"
  /// Newest first.
  virtual Result<std::vector<SceneRecord>> scenes(std::size_t offset, std::size_t limit) = 0;
  virtual Result<std::vector<BlobFile>> scene_files(const std::string& id) = 0;
  /// "scene_not_found". Whether it is in use is the caller's to know.
  virtual Status delete_scene(const std::string& id) = 0;
  /// A fresh private directory on the same file system, for unpacking; removed at the next start
  /// if the caller does not do so.
  virtual Result<std::filesystem::path> scratch_directory() = 0;

  /// Inserts or replaces. `sequence` is kept on replacement. "idempotency_key_reused" (kConflict)
  /// when another job has the key.
  virtual Status put_job(const JobRecord& job) = 0;
  virtual Result<JobRecord> job(const std::string& id) = 0;  ///< "job_not_found"
  virtual Result<std::optional<JobRecord>> job_with_key(const std::string& idempotency_key) = 0;
  /// The newest completed job with this picture.
  virtual Result<std::optional<JobRecord>> job_with_result(const std::string& result_digest) = 0;
  /// Newest first.
  virtual Result<std::vector<JobRecord>> jobs(const JobQuery& query) = 0;
  /// Removes the oldest finished jobs, with their images, beyond `keep`.
  virtual Status prune_jobs(std::size_t keep) = 0;

  /// Replaces the image of a job.
  virtual Status put_image(const std::string& job, const StoredImage& image) = 0;
  virtual Result<StoredImage> image(const std::string& job) = 0;  ///< "image_not_ready"

  /// Bytes of scenes and images together.
  [[nodiscard]] virtual std::uint64_t bytes_used() const = 0;
};

}  // namespace raykiln::server
