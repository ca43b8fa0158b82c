// A Store that lives as long as its process: for tests that need no disk, and to hold the conformance
// suite against a second implementation.
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "raykiln/base/config.hpp"
#include "raykiln/base/file_name.hpp"
#include "raykiln/base/ids.hpp"
#include "raykiln/base/sha256.hpp"
#include "raykiln/store/store.hpp"

namespace raykiln::tests {

/// Bytes without a name in any folder, which readers of files can open by a path all the same.
class MemoryFile {
 public:
  MemoryFile() : fd_(::memfd_create("upload", MFD_CLOEXEC)) {}
  ~MemoryFile() { ::close(fd_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  [[nodiscard]] bool append(std::span<const std::byte> bytes) const {
    return ::write(fd_, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size());
  }
  [[nodiscard]] std::string path() const { return "/proc/self/fd/" + std::to_string(fd_); }

 private:
  int fd_;
};

struct MemoryBudget {
  server::UploadLimits limits;
  std::uint64_t max_kept = 0;
  std::mutex mutex;
  std::uint64_t staged = 0, kept = 0;  ///< guarded by mutex
};

class MemoryUpload final : public server::SceneUpload {
 public:
  MemoryUpload(server::SceneKind kind, std::shared_ptr<MemoryBudget> budget)
      : kind_(kind), budget_(std::move(budget)) {}
  ~MemoryUpload() override {
    const std::scoped_lock lock(budget_->mutex);
    budget_->staged -= bytes_;
  }

  server::Status begin_file(const std::string& name) override {
    end_file();
    const bool single = kind_ != server::SceneKind::kFiles;
    if (entries_.size() >= (single ? 1 : budget_->limits.max_files)) {
      return wrong(server::ErrorKind::kTooLarge, "payload_too_large", name);
    }
    if (!server::is_safe_file_name(name, budget_->limits.max_name_bytes) || !names_.insert(name).second) {
      return wrong(server::ErrorKind::kInvalid, "unsafe_name", name);
    }
    entries_.push_back({name, 0, ""});
    contents_.push_back(std::make_shared<MemoryFile>());
    hash_.emplace();
    return server::success();
  }
  server::Status append(std::span<const std::byte> bytes) override {
    if (!hash_) return wrong(server::ErrorKind::kInternal, "internal", "");
    if (bytes_ + bytes.size() > budget_->limits.max_upload_bytes) {
      return wrong(server::ErrorKind::kTooLarge, "payload_too_large", "");
    }
    {
      const std::scoped_lock lock(budget_->mutex);
      bytes_ += bytes.size();
      budget_->staged += bytes.size();
      if (budget_->staged > budget_->limits.max_staging_bytes) {
        return wrong(server::ErrorKind::kTooMany, "too_many_uploads", "");
      }
      if (budget_->staged + budget_->kept > budget_->max_kept) {
        return wrong(server::ErrorKind::kStorageFull, "storage_full", "");
      }
    }
    hash_->update(bytes);
    entries_.back().bytes += bytes.size();
    if (!contents_.back()->append(bytes)) return wrong(server::ErrorKind::kInternal, "internal", "");
    return server::success();
  }
  server::Status finish() override {
    end_file();
    if (entries_.empty()) return wrong(server::ErrorKind::kInvalid, "scene_empty", "");
    return server::success();
  }

  [[nodiscard]] server::SceneKind kind() const override { return kind_; }
  [[nodiscard]] std::uint64_t bytes() const override { return bytes_; }
  [[nodiscard]] std::vector<server::SceneFileEntry> entries() const override { return entries_; }
  [[nodiscard]] std::string id() const override {
    if (kind_ != server::SceneKind::kFiles) return entries_.front().sha256;
    auto sorted = entries_;
    std::sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
    std::string list;
    for (const auto& e : sorted) list += e.name + '\0' + std::to_string(e.bytes) + '\0' + e.sha256 + '\n';
    return server::sha256_hex(list);
  }
  [[nodiscard]] std::vector<server::BlobFile> files() const override {
    std::vector<server::BlobFile> files;
    for (std::size_t i = 0; i < entries_.size(); ++i) {
      files.push_back({entries_[i].name, contents_[i]->path(), entries_[i].bytes});
    }
    return files;
  }
  [[nodiscard]] const std::vector<std::shared_ptr<MemoryFile>>& contents() const { return contents_; }

 private:
  static server::Error wrong(server::ErrorKind kind, const char* code, const std::string& where) {
    return {kind, code, "refused by the store in memory", where};
  }
  void end_file() {
    if (hash_) entries_.back().sha256 = server::to_hex(hash_->finish());
    hash_.reset();
  }

  server::SceneKind kind_;
  std::shared_ptr<MemoryBudget> budget_;
  std::vector<server::SceneFileEntry> entries_;
  std::vector<std::shared_ptr<MemoryFile>> contents_;
  std::set<std::string> names_;
  std::optional<server::Sha256> hash_;
  std::uint64_t bytes_ = 0;
};

class MemoryStore final : public server::Store {
 public:
  /// `scratch`: an existing directory for those who unpack.
  MemoryStore(const server::StoreSettings& settings, const server::UploadLimits& limits)
      : scratch_(settings.directory), budget_(std::make_shared<MemoryBudget>()) {
    budget_->limits = limits;
    budget_->max_kept = settings.max_bytes;
  }

  server::Result<std::unique_ptr<server::SceneUpload>> begin_upload(server::SceneKind kind) override {
    return std::unique_ptr<server::SceneUpload>(std::make_unique<MemoryUpload>(kind, budget_));
  }
  server::Result<bool> commit_scene(std::unique_ptr<server::SceneUpload> upload, const std::string& name,
                                    server::WallTime created, const std::string& report) override {
    const std::scoped_lock lock(mutex_);
    const auto* mine = dynamic_cast<MemoryUpload*>(upload.get());
    if (mine == nullptr) return server::Error{server::ErrorKind::kInternal, "internal", "not mine", ""};
    for (const Scene& scene : scenes_) {
      if (scene.record.id == mine->id()) return false;
    }
    scenes_.push_back({{mine->id(), mine->kind(), name, mine->bytes(), mine->entries(), created, report},
                       mine->contents(), mine->files()});
    keep(mine->bytes(), 0);
    return true;
  }
  server::Result<server::SceneRecord> scene(const std::string& id) override {
    const std::scoped_lock lock(mutex_);
    const auto found = find(id);
    if (found == scenes_.end()) return no_scene(id);
    return found->record;
  }
  server::Result<std::vector<server::SceneRecord>> scenes(std::size_t offset, std::size_t limit) override {
    const std::scoped_lock lock(mutex_);
    std::vector<server::SceneRecord> page;
    for (std::size_t i = offset; i < scenes_.size() && page.size() < limit; ++i) {
      page.push_back(scenes_[scenes_.size() - 1 - i].record);
    }
    return page;
  }
  server::Result<std::vector<server::BlobFile>> scene_files(const std::string& id) override {
    const std::scoped_lock lock(mutex_);
    const auto found = find(id);
    if (found == scenes_.end()) return no_scene(id);
    return found->files;
  }
  server::Status delete_scene(const std::string& id) override {
    const std::scoped_lock lock(mutex_);
    const auto found = find(id);
    if (found == scenes_.end()) return no_scene(id);
    keep(0, found->record.bytes);
    scenes_.erase(found);
    return server::success();
  }
  server::Result<std::filesystem::path> scratch_directory() override {
    const auto directory = scratch_ / server::random_id("s");
    std::filesystem::create_directories(directory);
    return directory;
  }

  server::Status put_job(const server::JobRecord& job) override {
    const std::scoped_lock lock(mutex_);
    for (const auto& [id, other] : jobs_) {
      if (job.idempotency_key.empty() || id == job.id || other.idempotency_key != job.idempotency_key) continue;
      return server::Error{server::ErrorKind::kConflict, "idempotency_key_reused", "", ""};
    }
    auto& kept = jobs_[job.id];
    const std::uint64_t sequence = kept.sequence > 0 ? kept.sequence : ++last_sequence_;
    kept = job;
    kept.sequence = sequence;
    return server::success();
  }
  server::Result<server::JobRecord> job(const std::string& id) override {
    const std::scoped_lock lock(mutex_);
    const auto found = jobs_.find(id);
    if (found != jobs_.end()) return found->second;
    return server::Error{server::ErrorKind::kNotFound, "job_not_found", "there is no such job", id};
  }
  server::Result<std::optional<server::JobRecord>> job_with_key(const std::string& key) override {
    const std::scoped_lock lock(mutex_);
    for (const auto& [id, job] : jobs_) {
      if (!key.empty() && job.idempotency_key == key) return std::optional(job);
    }
    return std::optional<server::JobRecord>();
  }
  server::Result<std::optional<server::JobRecord>> job_with_result(const std::string& digest) override {
    const std::scoped_lock lock(mutex_);
    for (const auto& job : newest_first()) {
      const bool wanted = job.state == server::JobState::kCompleted && job.result_digest == digest;
      if (!digest.empty() && wanted) return std::optional(job);
    }
    return std::optional<server::JobRecord>();
  }
  server::Result<std::vector<server::JobRecord>> jobs(const server::JobQuery& query) override {
    const std::scoped_lock lock(mutex_);
    std::vector<server::JobRecord> page;
    for (const auto& job : newest_first()) {
      const auto& states = query.states;
      const bool wanted = (states.empty() || std::find(states.begin(), states.end(), job.state) != states.end()) &&
                          (query.scene.empty() || query.scene == job.scene) &&
                          (query.before == 0 || job.sequence < query.before);
      if (wanted && page.size() < query.limit) page.push_back(job);
    }
    return page;
  }
  server::Status prune_jobs(std::size_t keep_jobs) override {
    const std::scoped_lock lock(mutex_);
    std::size_t seen = 0;
    for (const auto& job : newest_first()) {
      if (!server::is_final(job.state) || ++seen <= keep_jobs) continue;
      drop_image(job.id);
      jobs_.erase(job.id);
    }
    return server::success();
  }

  server::Status put_image(const std::string& job, const server::StoredImage& image) override {
    const std::scoped_lock lock(mutex_);
    const std::uint64_t bytes = image.rgb.size() * sizeof(float);
    {
      const std::scoped_lock budget(budget_->mutex);
      if (budget_->kept + budget_->staged + bytes > budget_->max_kept) {
        return server::Error{server::ErrorKind::kStorageFull, "storage_full", "", ""};
      }
    }
    drop_image(job);
    keep(bytes, 0);
    images_[job] = image;
    return server::success();
  }
  server::Result<server::StoredImage> image(const std::string& job) override {
    const std::scoped_lock lock(mutex_);
    const auto found = images_.find(job);
    if (found != images_.end()) return found->second;
    return server::Error{server::ErrorKind::kNotFound, "image_not_ready", "there is no picture", ""};
  }
  [[nodiscard]] std::uint64_t bytes_used() const override {
    const std::scoped_lock lock(budget_->mutex);
    return budget_->kept;
  }

 private:
  struct Scene {
    server::SceneRecord record;
    std::vector<std::shared_ptr<MemoryFile>> contents;
    std::vector<server::BlobFile> files;
  };
  static server::Error no_scene(const std::string& id) {
    return {server::ErrorKind::kNotFound, "scene_not_found", "there is no such scene", id};
  }
  std::vector<Scene>::iterator find(const std::string& id) {
    return std::find_if(scenes_.begin(), scenes_.end(), [&](const Scene& s) { return s.record.id == id; });
  }
  [[nodiscard]] std::vector<server::JobRecord> newest_first() const {
    std::vector<server::JobRecord> sorted;
    for (const auto& entry : jobs_) sorted.push_back(entry.second);
    std::sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.sequence > b.sequence; });
    return sorted;
  }
  void drop_image(const std::string& job) {
    const auto found = images_.find(job);
    if (found == images_.end()) return;
    keep(0, found->second.rgb.size() * sizeof(float));
    images_.erase(found);
  }
  void keep(std::uint64_t more, std::uint64_t less) const {
    const std::scoped_lock lock(budget_->mutex);
    budget_->kept += more;
    budget_->kept -= less;
  }

  std::filesystem::path scratch_;
  std::shared_ptr<MemoryBudget> budget_;
  std::mutex mutex_;
  std::vector<Scene> scenes_;  ///< oldest first
  std::map<std::string, server::JobRecord> jobs_;
  std::map<std::string, server::StoredImage> images_;
  std::uint64_t last_sequence_ = 0;
};

}  // namespace raykiln::tests
