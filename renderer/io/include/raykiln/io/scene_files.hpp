// The set of named files that an import reads: a folder, or bytes in memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace raykiln::render {

/// One open file, read from its beginning to its end.
class SceneFile {
 public:
  virtual ~SceneFile() = default;
  /// Bytes of the file when it was opened.
  [[nodiscard]] virtual std::uint64_t size() const = 0;
  /// Fills the front of `to`; returns the number of bytes, 0 at the end, nothing when the device
  /// fails.
  [[nodiscard]] virtual std::optional<std::size_t> read(std::span<char> to) = 0;
};

/// Names are relative, separated by '/', without "." or ".." parts. Safe to use from one thread.
class SceneFiles {
 public:
  virtual ~SceneFiles() = default;
  /// All names, sorted.
  [[nodiscard]] virtual std::vector<std::string> names() const = 0;
  /// Null when there is no such file, or when it may not be read.
  [[nodiscard]] virtual std::unique_ptr<SceneFile> open(const std::string& name) const = 0;
};

/// Regular files below a folder. Symbolic links are followed by nobody: neither listed nor opened,
/// so that no name leads out of the folder.
class DirectoryFiles final : public SceneFiles {
 public:
  /// `root` need not exist (then there are no files). At most `max_files` names are listed.
  explicit DirectoryFiles(std::filesystem::path root, std::size_t max_files = 100'000);
  [[nodiscard]] std::vector<std::string> names() const override;
  [[nodiscard]] std::unique_ptr<SceneFile> open(const std::string& name) const override;

 private:
  std::filesystem::path root_;
  std::size_t max_files_;
};

/// Bytes held in memory, for tests and for small uploads.
class MemoryFiles final : public SceneFiles {
 public:
  MemoryFiles() = default;
  explicit MemoryFiles(std::map<std::string, std::string> files) : files_(std::move(files)) {}
  void add(std::string name, std::string bytes) { files_[std::move(name)] = std::move(bytes); }
  [[nodiscard]] std::vector<std::string> names() const override;
  [[nodiscard]] std::unique_ptr<SceneFile> open(const std::string& name) const override;

 private:
  std::map<std::string, std::string> files_;
};

/// True for a relative name without empty, "." or ".." parts, backslashes, control characters and
/// with at most 1024 bytes: the only names that open() accepts.
[[nodiscard]] bool is_safe_name(const std::string& name);

}  // namespace raykiln::render
