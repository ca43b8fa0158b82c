// An upload in a directory of its own.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "file_ops.hpp"
#include "raykiln/base/config.hpp"
#include "raykiln/base/sha256.hpp"
#include "raykiln/store/store.hpp"

namespace raykiln::server {

/// Bytes on disk, shared by the store and its uploads.
struct DiskBudget {
  std::atomic<std::uint64_t> staged{0};
  std::atomic<std::uint64_t> kept{0};
  std::uint64_t max_staged = 0;
  std::uint64_t max_kept = 0;
};

/// SHA-256 over "name 0 length 0 sha256 \n" of all files in the order of their names.
[[nodiscard]] std::string list_digest(const std::vector<SceneFileEntry>& entries);

class DirectoryUpload final : public SceneUpload {
 public:
  /// `directory` exists and is empty; it belongs to the upload.
  DirectoryUpload(SceneKind kind, std::filesystem::path directory, const UploadLimits& limits,
                  std::shared_ptr<DiskBudget> budget);
  ~DirectoryUpload() override;
  DirectoryUpload(const DirectoryUpload&) = delete;
  DirectoryUpload& operator=(const DirectoryUpload&) = delete;

  Status begin_file(const std::string& name) override;
  Status append(std::span<const std::byte> bytes) override;
  Status finish() override;
  [[nodiscard]] SceneKind kind() const override { return kind_; }
  [[nodiscard]] std::uint64_t bytes() const override { return bytes_; }
  [[nodiscard]] std::string id() const override;
  [[nodiscard]] std::vector<SceneFileEntry> entries() const override { return entries_; }
  [[nodiscard]] std::vector<BlobFile> files() const override;

  [[nodiscard]] const std::filesystem::path& directory() const { return directory_; }

 private:
  Status end_file();
  [[nodiscard]] std::optional<Error> reserve(std::uint64_t more);

  SceneKind kind_;
  std::filesystem::path directory_;
  UploadLimits limits_;
  std::shared_ptr<DiskBudget> budget_;
  std::vector<SceneFileEntry> entries_;
  std::set<std::string> names_;
  std::optional<Sha256> hash_;
  OwnedFd file_;
  std::uint64_t bytes_ = 0;
};

}  // namespace raykiln::server
