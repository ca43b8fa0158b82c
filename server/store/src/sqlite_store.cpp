#include <sqlite3.h>

#include <cerrno>
#include <stdexcept>

#include "directory_store.hpp"
#include "image_file.hpp"
#include "raykiln/base/ids.hpp"
#include "sqlite_guard.hpp"
#include "sqlite_records.hpp"

namespace raykiln::server {
namespace {

Error scene_not_found(const std::string& id) {
  return {ErrorKind::kNotFound, "scene_not_found", "there is no such scene", id};
}

/// All of it or nothing: a store that was cut off between two steps could never be opened again.
void check_schema(SQLite::Database& db) {
  SQLite::Transaction whole(db);
  const int version = db.execAndGet("PRAGMA user_version").getInt();
  if (version > kSchemaVersion) {
    throw std::runtime_error("the store was written by a newer version of this program");
  }
  if (version > 0) upgrade_tables(db, version);
  create_tables(db);
  db.exec("PRAGMA user_version = " + std::to_string(kSchemaVersion));
  whole.commit();
}

}  // namespace

DirectoryStore::DirectoryStore(StorePaths paths, OwnedFd lock, const StoreSettings& settings,
                               const UploadLimits& limits, Log log)
    : paths_(std::move(paths)),
      lock_(std::move(lock)),
      limits_(limits),
      log_(std::move(log)),
      budget_(std::make_shared<DiskBudget>()),
      db_(paths_.database().string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE, 5000) {
  budget_->max_kept = settings.max_bytes;
  budget_->max_staged = limits.max_staging_bytes;
  // Write-ahead log with a flush at every commit: an answer that was given stays true.
  db_.exec("PRAGMA journal_mode = WAL");
  db_.exec("PRAGMA synchronous = FULL");
  check_schema(db_);
}

Result<std::unique_ptr<SceneUpload>> DirectoryStore::begin_upload(SceneKind kind) {
  const auto directory = paths_.staging() / random_id("u");
  if (auto made = make_directory(directory); !made) return made.error();
  return std::unique_ptr<SceneUpload>(
      std::make_unique<DirectoryUpload>(kind, directory, limits_, budget_));
}

Result<bool> DirectoryStore::install(DirectoryUpload& upload, const SceneRecord& scene) {
  if (find_scene(db_, scene.id)) return false;
  // Files first, record second: a process that dies in between leaves files without a record, and
  // the next start removes them.
  remove_quietly(paths_.scene(scene.id));
  if (auto moved = move_into_place(upload.directory(), paths_.scene(scene.id)); !moved) {
    return moved.error();
  }
  try {
    insert_scene(db_, scene);
  } catch (...) {
    remove_quietly(paths_.scene(scene.id));
    throw;
  }
  budget_->kept += scene.bytes;
  return true;
}

Result<bool> DirectoryStore::commit_scene(std::unique_ptr<SceneUpload> upload,
                                          const std::string& name, WallTime created,
                                          const std::string& report) {
  auto* mine = dynamic_cast<DirectoryUpload*>(upload.get());
  if (mine == nullptr) return Error{ErrorKind::kInternal, "internal", "an upload of another store", ""};
  SceneRecord scene;
  scene.id = mine->id();
  scene.kind = mine->kind();
  scene.name = name;
  scene.bytes = mine->bytes();
  scene.files = mine->entries();
  scene.created = created;
  scene.report = report;
  const std::scoped_lock lock(mutex_);
  return guarded([&] { return install(*mine, scene); });
}

Result<SceneRecord> DirectoryStore::scene(const std::string& id) {
  const std::scoped_lock lock(mutex_);
  return guarded([&]() -> Result<SceneRecord> {
    auto found = find_scene(db_, id);
    if (!found) return scene_not_found(id);
    return std::move(*found);
  });
}

Result<std::vector<SceneRecord>> DirectoryStore::scenes(std::size_t offset, std::size_t limit) {
  const std::scoped_lock lock(mutex_);
  return guarded([&]() -> Result<std::vector<SceneRecord>> { return list_scenes(db_, offset, limit); });
}

Result<std::vector<BlobFile>> DirectoryStore::scene_files(const std::string& id) {
  const std::scoped_lock lock(mutex_);
  return guarded([&]() -> Result<std::vector<BlobFile>> {
    const auto found = find_scene(db_, id);
    if (!found) return scene_not_found(id);
    std::vector<BlobFile> files;
    for (const SceneFileEntry& entry : found->files) {
      files.push_back({entry.name, paths_.scene(id) / std::to_string(files.size()), entry.bytes});
    }
    return files;
  });
}

Status DirectoryStore::delete_scene(const std::string& id) {
  const std::scoped_lock lock(mutex_);
  return guarded([&]() -> Status {
    const auto found = find_scene(db_, id);
    if (!found) return scene_not_found(id);
    // Record first: files without a record are removed at the next start, the reverse is damage.
    erase_scene(db_, id);
    remove_quietly(paths_.scene(id));
    budget_->kept -= found->bytes;
    return success();
  });
}

Result<std::filesystem::path> DirectoryStore::scratch_directory() {
  const auto directory = paths_.scratch() / random_id("s");
  if (auto made = make_directory(directory); !made) return made.error();
  return directory;
}

Status DirectoryStore::put_job(const JobRecord& job) {
  const std::scoped_lock lock(mutex_);
  return guarded([&]() -> Status {
    if (!job.idempotency_key.empty()) {
      const auto holder = find_job_with_key(db_, job.idempotency_key);
      if (holder && holder->id != job.id) {
        return Error{ErrorKind::kConflict, "idempotency_key_reused", "another job has this key", ""};
      }
    }
    upsert_job(db_, job);
    return success();
  });
}

Result<JobRecord> DirectoryStore::job(const std::string& id) {
  const std::scoped_lock lock(mutex_);
  return guarded([&]() -> Result<JobRecord> {
    auto found = find_job(db_, id);
    if (!found) return Error{ErrorKind::kNotFound, "job_not_found", "there is no such job", id};
    return std::move(*found);
  });
}

Result<std::optional<JobRecord>> DirectoryStore::job_with_key(const std::string& idempotency_key) {
  const std::scoped_lock lock(mutex_);
  return guarded([&]() -> Result<std::optional<JobRecord>> {
    if (idempotency_key.empty()) return std::optional<JobRecord>();
    return find_job_with_key(db_, idempotency_key);
  });
}

Result<std::optional<JobRecord>> DirectoryStore::job_with_result(const std::string& result_digest) {
  const std::scoped_lock lock(mutex_);
  return guarded([&]() -> Result<std::optional<JobRecord>> {
    if (result_digest.empty()) return std::optional<JobRecord>();
    return find_job_with_result(db_, result_digest);
  });
}

Result<std::vector<JobRecord>> DirectoryStore::jobs(const JobQuery& query) {
  const std::scoped_lock lock(mutex_);
  return guarded([&]() -> Result<std::vector<JobRecord>> { return list_jobs(db_, query); });
}

Status DirectoryStore::prune_jobs(std::size_t keep) {
  const std::scoped_lock lock(mutex_);
  return guarded([&]() -> Status {
    for (const std::string& id : erase_old_jobs(db_, keep)) remove_image(id);
    return success();
  });
}

void DirectoryStore::remove_image(const std::string& job) {
  std::error_code error;
  const auto bytes = std::filesystem::file_size(paths_.image(job), error);
  if (error) return;  // there is none
  remove_quietly(paths_.image(job));
  budget_->kept -= bytes;
}

Status DirectoryStore::put_image(const std::string& job, const StoredImage& image) {
  if (!is_plain_id(job)) return Error{ErrorKind::kInternal, "internal", "a job id is no name", job};
  const std::uint64_t bytes = image_file_bytes(image);
  if (budget_->kept + budget_->staged + bytes > budget_->max_kept) {
    return Error{ErrorKind::kStorageFull, "storage_full", "the store has no room for the picture", ""};
  }
  const auto staged = paths_.staging() / random_id("i");
  auto written = write_image_file(staged, image);
  if (written) {
    const std::scoped_lock lock(mutex_);
    remove_image(job);
    written = move_into_place(staged, paths_.image(job));
    if (written) budget_->kept += bytes;
  }
  if (!written) remove_quietly(staged);
  return written;
}

Result<StoredImage> DirectoryStore::image(const std::string& job) {
  if (!is_plain_id(job)) {
    return Error{ErrorKind::kNotFound, "image_not_ready", "there is no picture", ""};
  }
  return read_image_file(paths_.image(job));
}

}  // namespace raykiln::server
