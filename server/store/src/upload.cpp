#include "upload.hpp"

#include <algorithm>

#include "raykiln/base/file_name.hpp"

namespace raykiln::server {

std::string list_digest(const std::vector<SceneFileEntry>& entries) {
  std::vector<SceneFileEntry> sorted = entries;
  std::sort(sorted.begin(), sorted.end(),
            [](const SceneFileEntry& a, const SceneFileEntry& b) { return a.name < b.name; });
  Sha256 hash;
  for (const SceneFileEntry& entry : sorted) {
    hash.update(entry.name + '\0' + std::to_string(entry.bytes) + '\0' + entry.sha256 + '\n');
  }
  return to_hex(hash.finish());
}

DirectoryUpload::DirectoryUpload(SceneKind kind, std::filesystem::path directory,
                                 const UploadLimits& limits, std::shared_ptr<DiskBudget> budget)
    : kind_(kind),
      directory_(std::move(directory)),
      limits_(limits),
      budget_(std::move(budget)) {}

DirectoryUpload::~DirectoryUpload() {
  file_ = OwnedFd();
  remove_quietly(directory_);  // committed: it has been renamed, nothing is there
  budget_->staged -= bytes_;
}

Status DirectoryUpload::begin_file(const std::string& name) {
  if (auto ended = end_file(); !ended) return ended;
  const bool single = kind_ != SceneKind::kFiles;
  if (entries_.size() >= (single ? 1 : limits_.max_files)) {
    return Error{ErrorKind::kTooLarge, "payload_too_large", "too many files in one upload", name};
  }
  if (!is_safe_file_name(name, limits_.max_name_bytes)) {
    return Error{ErrorKind::kInvalid, "unsafe_name", "a file name that cannot be kept", name};
  }
  if (!names_.insert(name).second) {
    return Error{ErrorKind::kInvalid, "unsafe_name", "the same file name twice", name};
  }
  auto file = create_file(directory_ / std::to_string(entries_.size()));
  if (!file) return file.error();
  file_ = std::move(*file);
  hash_.emplace();
  entries_.push_back({name, 0, ""});
  return success();
}

std::optional<Error> DirectoryUpload::reserve(std::uint64_t more) {
  if (bytes_ + more > limits_.max_upload_bytes) {
    return Error{ErrorKind::kTooLarge, "payload_too_large",
                 "an upload may have " + std::to_string(limits_.max_upload_bytes) + " bytes", ""};
  }
  const std::uint64_t staged = budget_->staged.fetch_add(more) + more;
  bytes_ += more;
  if (staged > budget_->max_staged) {
    return Error{ErrorKind::kTooMany, "too_many_uploads", "too many bytes are being uploaded at once",
                 "", 10};
  }
  if (staged + budget_->kept > budget_->max_kept) {
    return Error{ErrorKind::kStorageFull, "storage_full", "the store has no room for this upload", ""};
  }
  return std::nullopt;
}

Status DirectoryUpload::append(std::span<const std::byte> bytes) {
  if (!file_.is_open()) {
    return Error{ErrorKind::kInternal, "internal", "bytes without a file", ""};
  }
  if (auto error = reserve(bytes.size())) return *error;
  if (auto written = write_all(file_.get(), bytes); !written) return written;
  hash_->update(bytes);
  entries_.back().bytes += bytes.size();
  return success();
}

Status DirectoryUpload::end_file() {
  if (!file_.is_open()) return success();
  entries_.back().sha256 = to_hex(hash_->finish());
  hash_.reset();
  auto synced = sync_file(file_.get());
  file_ = OwnedFd();
  return synced;
}

Status DirectoryUpload::finish() {
  if (auto ended = end_file(); !ended) return ended;
  if (entries_.empty()) {
    return Error{ErrorKind::kInvalid, "scene_empty", "the upload holds no file", ""};
  }
  return sync_directory(directory_);
}

std::string DirectoryUpload::id() const {
  return kind_ == SceneKind::kFiles ? list_digest(entries_) : entries_.front().sha256;
}

std::vector<BlobFile> DirectoryUpload::files() const {
  std::vector<BlobFile> files;
  for (const SceneFileEntry& entry : entries_) {
    files.push_back({entry.name, directory_ / std::to_string(files.size()), entry.bytes});
  }
  return files;
}

}  // namespace raykiln::server
