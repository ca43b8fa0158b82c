#include "raykiln/workers/archive.hpp"

#include <archive.h>
#include <archive_entry.h>

#include <array>
#include <fstream>
#include <memory>
#include <set>

#include "raykiln/base/file_name.hpp"

namespace raykiln::server {
namespace {

/// Below this no ratio is a bomb: a small file of equal bytes packs very well.
constexpr std::uint64_t kHarmlessBytes = 16 * kMiB;

struct FreeArchive {
  void operator()(archive* a) const { archive_read_free(a); }
};
using OpenArchive = std::unique_ptr<archive, FreeArchive>;

/// The name as far as it can be shown in an answer.
std::string printable(const std::string& name) {
  std::string shown = name.substr(0, 200);
  for (char& c : shown) {
    if (static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) > 0x7E) c = '?';
  }
  return shown;
}

Error invalid(const std::string& why, const std::string& entry) {
  return {ErrorKind::kInvalid, "archive_invalid", why, printable(entry)};
}
Error too_large(const std::string& why, const std::string& entry) {
  return {ErrorKind::kTooLarge, "archive_too_large", why, printable(entry)};
}
Error unsafe(const std::string& why, const std::string& entry) {
  return {ErrorKind::kInvalid, "unsafe_name", why, printable(entry)};
}
Error unreadable(archive* a, const std::string& entry) {
  const char* text = archive_error_string(a);
  return invalid(std::string("the archive cannot be read: ") + (text != nullptr ? text : "damaged"),
                 entry);
}

class Unpacker {
 public:
  Unpacker(std::filesystem::path directory, const UploadLimits& limits, std::uint64_t packed,
           std::stop_token stop)
      : directory_(std::move(directory)), limits_(limits), packed_(packed), stop_(std::move(stop)) {}

  Result<std::vector<BlobFile>> run(archive* a) {
    archive_entry* entry = nullptr;
    for (int code = next(a, &entry); code != ARCHIVE_EOF; code = next(a, &entry)) {
      // ARCHIVE_WARN is damage too: nothing is guessed about files of strangers.
      if (code != ARCHIVE_OK) return unreadable(a, "");
      if (auto error = take(a, entry)) return *error;
    }
    // With the end-of-archive marker reached, libarchive has checked the central directory.
    if (files_.empty()) return Error{ErrorKind::kInvalid, "scene_empty", "the archive holds no file", ""};
    return std::move(files_);
  }

 private:
  static int next(archive* a, archive_entry** entry) { return archive_read_next_header(a, entry); }

  std::optional<Error> take(archive* a, archive_entry* entry) {
    if (++entries_ > limits_.max_entries) {
      return too_large("more than " + std::to_string(limits_.max_entries) + " entries", "");
    }
    const char* raw = archive_entry_pathname(entry);
    std::string name = raw != nullptr ? raw : "";
    if (archive_entry_is_encrypted(entry) != 0) return invalid("the entry is encrypted", name);
    if (archive_entry_hardlink(entry) != nullptr || archive_entry_filetype(entry) == AE_IFLNK) {
      return invalid("the entry is a link", name);
    }
    if (archive_entry_filetype(entry) == AE_IFDIR) {
      while (!name.empty() && name.back() == '/') name.pop_back();
      if (is_safe_file_name(name, limits_.max_name_bytes)) return std::nullopt;
      return unsafe("the entry's name leaves the archive or cannot be kept", name);
    }
    if (archive_entry_filetype(entry) != AE_IFREG) return invalid("the entry is no file", name);
    if (!is_safe_file_name(name, limits_.max_name_bytes)) {
      return unsafe("the entry's name leaves the archive or cannot be kept", name);
    }
    if (!names_.insert(name).second) return unsafe("two entries have the same name", name);
    return unpack(a, name);
  }

  std::optional<Error> unpack(archive* a, const std::string& name) {
    const auto path = directory_ / std::to_string(files_.size());
    std::ofstream out(path, std::ios::binary);
    std::uint64_t bytes = 0;
    std::array<char, 256 * 1024> buffer;
    while (true) {
      if (stop_.stop_requested()) {
        return Error{ErrorKind::kUnavailable, "import_stopped", "the import was stopped", ""};
      }
      const la_ssize_t got = archive_read_data(a, buffer.data(), buffer.size());
      if (got < 0) return unreadable(a, name);
      if (got == 0) break;
      bytes += static_cast<std::uint64_t>(got);
      total_ += static_cast<std::uint64_t>(got);
      if (auto error = over_limit(name)) return error;
      if (!out.write(buffer.data(), got)) return disk_full(name);
    }
    out.close();
    if (!out) return disk_full(name);
    files_.push_back({name, path, bytes});
    return std::nullopt;
  }

  std::optional<Error> over_limit(const std::string& name) const {
    if (total_ > limits_.max_unpacked_bytes) {
      return too_large("more than " + std::to_string(limits_.max_unpacked_bytes) +
                           " bytes when unpacked",
                       name);
    }
    const double ratio = static_cast<double>(total_) / static_cast<double>(packed_);
    if (total_ > kHarmlessBytes && ratio > limits_.max_unpack_ratio) {
      return too_large("unpacks to more than " +
                           std::to_string(static_cast<int>(limits_.max_unpack_ratio)) +
                           " times its size",
                       name);
    }
    return std::nullopt;
  }

  static Error disk_full(const std::string& name) {
    return {ErrorKind::kStorageFull, "storage_full", "no room to unpack the archive", printable(name)};
  }

  std::filesystem::path directory_;
  const UploadLimits& limits_;
  std::uint64_t packed_;
  std::stop_token stop_;
  std::size_t entries_ = 0;
  std::uint64_t total_ = 0;
  std::set<std::string> names_;
  std::vector<BlobFile> files_;
};

}  // namespace

Result<std::vector<BlobFile>> unpack_zip(const std::filesystem::path& path,
                                         const std::filesystem::path& directory,
                                         const UploadLimits& limits, std::stop_token stop) {
  std::error_code error;
  const auto packed = std::filesystem::file_size(path, error);
  if (error || packed == 0) return invalid("the archive is empty", "");
  const OpenArchive a(archive_read_new());
  if (!a) return Error{ErrorKind::kInternal, "internal", "out of memory", ""};
  // The seekable reader goes by the central directory: what a truncated archive does not have.
  archive_read_support_format_zip_seekable(a.get());
  if (archive_read_open_filename(a.get(), path.c_str(), 64 * 1024) != ARCHIVE_OK) {
    return unreadable(a.get(), "");
  }
  return Unpacker(directory, limits, packed, std::move(stop)).run(a.get());
}

}  // namespace raykiln::server
