#include "raykiln/io/scene_files.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string_view>
#include <utility>

namespace raykiln::render {
namespace {

constexpr std::size_t kMaxNameBytes = 1024;

class FileHandle {
 public:
  explicit FileHandle(int fd) : fd_(fd) {}
  FileHandle(FileHandle&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  FileHandle& operator=(FileHandle&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  FileHandle(const FileHandle&) = delete;
  FileHandle& operator=(const FileHandle&) = delete;
  ~FileHandle() {
    if (fd_ >= 0) ::close(fd_);
  }
  [[nodiscard]] int get() const { return fd_; }
  [[nodiscard]] bool valid() const { return fd_ >= 0; }

 private:
  int fd_;
};

class DiskFile final : public SceneFile {
 public:
  DiskFile(FileHandle handle, std::uint64_t size) : handle_(std::move(handle)), size_(size) {}
  [[nodiscard]] std::uint64_t size() const override { return size_; }
  [[nodiscard]] std::optional<std::size_t> read(std::span<char> to) override {
    std::size_t done = 0;
    while (done < to.size()) {
      const ssize_t n = ::read(handle_.get(), to.data() + done, to.size() - done);
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) return std::nullopt;
      if (n == 0) break;
      done += static_cast<std::size_t>(n);
    }
    return done;
  }

 private:
  FileHandle handle_;
  std::uint64_t size_;
};

class MemoryFile final : public SceneFile {
 public:
  explicit MemoryFile(std::string_view bytes) : bytes_(bytes) {}
  [[nodiscard]] std::uint64_t size() const override { return bytes_.size(); }
  [[nodiscard]] std::optional<std::size_t> read(std::span<char> to) override {
    const std::size_t n = std::min(to.size(), bytes_.size() - next_);
    if (n > 0) std::memcpy(to.data(), bytes_.data() + next_, n);
    next_ += n;
    return n;
  }

 private:
  std::string_view bytes_;
  std::size_t next_ = 0;
};

// Opens part after part relative to the folder before, so that a symbolic link anywhere below the
// root fails with ELOOP instead of being followed, also when it appears while we look.
FileHandle open_below(const std::filesystem::path& root, std::string_view name) {
  FileHandle at(::open(root.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  while (at.valid()) {
    const std::size_t slash = name.find('/');
    const std::string part(name.substr(0, slash));
    const bool last = slash == std::string_view::npos;
    // O_NONBLOCK: opening a named pipe must not wait for a writer.
    const int flags = O_RDONLY | O_NOFOLLOW | O_CLOEXEC | (last ? O_NONBLOCK : O_DIRECTORY);
    at = FileHandle(::openat(at.get(), part.c_str(), flags));
    if (last) break;
    name.remove_prefix(slash + 1);
  }
  return at;
}

}  // namespace

bool is_safe_name(const std::string& name) {
  if (name.empty() || name.size() > kMaxNameBytes) return false;
  for (const char c : name) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F || c == '\\') return false;
  }
  std::string_view rest = name;
  while (true) {
    const std::size_t slash = rest.find('/');
    const std::string_view part = rest.substr(0, slash);
    if (part.empty() || part == "." || part == "..") return false;
    if (slash == std::string_view::npos) return true;
    rest.remove_prefix(slash + 1);
  }
}

DirectoryFiles::DirectoryFiles(std::filesystem::path root, std::size_t max_files)
    : root_(std::move(root)), max_files_(max_files) {}

std::vector<std::string> DirectoryFiles::names() const {
  namespace fs = std::filesystem;
  std::vector<std::string> found;
  std::error_code error;
  fs::recursive_directory_iterator entry(root_, fs::directory_options::skip_permission_denied,
                                         error);
  for (; !error && entry != fs::recursive_directory_iterator(); entry.increment(error)) {
    std::error_code ignored;  // an entry that cannot be looked at is an entry that is not there
    if (entry->symlink_status(ignored).type() != fs::file_type::regular) continue;
    std::string relative = entry->path().lexically_relative(root_).generic_string();
    if (is_safe_name(relative)) found.push_back(std::move(relative));
    if (found.size() == max_files_) break;
  }
  std::sort(found.begin(), found.end());
  return found;
}

std::unique_ptr<SceneFile> DirectoryFiles::open(const std::string& name) const {
  if (!is_safe_name(name)) return nullptr;
  FileHandle handle = open_below(root_, name);
  struct stat about {};
  if (!handle.valid() || ::fstat(handle.get(), &about) != 0 || !S_ISREG(about.st_mode)) {
    return nullptr;
  }
  return std::make_unique<DiskFile>(std::move(handle), static_cast<std::uint64_t>(about.st_size));
}

std::vector<std::string> MemoryFiles::names() const {
  std::vector<std::string> found;
  for (const auto& file : files_) found.push_back(file.first);
  return found;
}

std::unique_ptr<SceneFile> MemoryFiles::open(const std::string& name) const {
  const auto found = files_.find(name);
  if (found == files_.end() || !is_safe_name(name)) return nullptr;
  return std::make_unique<MemoryFile>(found->second);
}

}  // namespace raykiln::render
