// The class behind open_sqlite_store.
#pragma once

#include <filesystem>
#include <memory>
#include <mutex>
#include <string>

#include <SQLiteCpp/SQLiteCpp.h>

#include "file_ops.hpp"
#include "raykiln/base/config.hpp"
#include "raykiln/base/log.hpp"
#include "raykiln/store/store.hpp"
#include "upload.hpp"

namespace raykiln::server {

/// Paths of a store.
struct StorePaths {
  std::filesystem::path root;
  [[nodiscard]] std::filesystem::path database() const { return root / "raykiln.db"; }
  [[nodiscard]] std::filesystem::path lock() const { return root / "lock"; }
  [[nodiscard]] std::filesystem::path staging() const { return root / "staging"; }
  [[nodiscard]] std::filesystem::path scratch() const { return root / "scratch"; }
  [[nodiscard]] std::filesystem::path scenes() const { return root / "scenes"; }
  [[nodiscard]] std::filesystem::path images() const { return root / "images"; }
  [[nodiscard]] std::filesystem::path scene(const std::string& id) const { return scenes() / id; }
  [[nodiscard]] std::filesystem::path image(const std::string& job) const { return images() / job; }
};

class DirectoryStore final : public Store {
 public:
  /// Precondition: the directories exist and the lock is held. Throws SQLite::Exception.
  DirectoryStore(StorePaths paths, OwnedFd lock, const StoreSettings& settings,
                 const UploadLimits& limits, Log log);

  /// Brings records and files into agreement after whatever happened before.
  void recover();

  Result<std::unique_ptr<SceneUpload>> begin_upload(SceneKind kind) override;
  Result<bool> commit_scene(std::unique_ptr<SceneUpload> upload, const std::string& name,
                            WallTime created, const std::string& report) override;
  Result<SceneRecord> scene(const std::string& id) override;
  Result<std::vector<SceneRecord>> scenes(std::size_t offset, std::size_t limit) override;
  Result<std::vector<BlobFile>> scene_files(const std::string& id) override;
  Status delete_scene(const std::string& id) override;
  Result<std::filesystem::path> scratch_directory() override;
  Status put_job(const JobRecord& job) override;
  Result<JobRecord> job(const std::string& id) override;
  Result<std::optional<JobRecord>> job_with_key(const std::string& idempotency_key) override;
  Result<std::optional<JobRecord>> job_with_result(const std::string& result_digest) override;
  Result<std::vector<JobRecord>> jobs(const JobQuery& query) override;
  Status prune_jobs(std::size_t keep) override;
  Status put_image(const std::string& job, const StoredImage& image) override;
  Result<StoredImage> image(const std::string& job) override;
  [[nodiscard]] std::uint64_t bytes_used() const override { return budget_->kept; }

 private:
  void drop_torn_scenes();
  void drop_unknown_files();
  void remove_image(const std::string& job);
  Result<bool> install(DirectoryUpload& upload, const SceneRecord& scene);

  StorePaths paths_;
  OwnedFd lock_;
  UploadLimits limits_;
  Log log_;
  std::shared_ptr<DiskBudget> budget_;
  std::mutex mutex_;  ///< guards db_, and the scene and image directories together with it
  SQLite::Database db_;
};

}  // namespace raykiln::server
