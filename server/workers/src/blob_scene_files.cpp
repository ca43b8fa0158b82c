#include "blob_scene_files.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

namespace raykiln::server {
namespace {

class BlobSceneFile final : public render::SceneFile {
 public:
  BlobSceneFile(int fd, std::uint64_t size) : fd_(fd), size_(size) {}
  ~BlobSceneFile() override { ::close(fd_); }
  BlobSceneFile(const BlobSceneFile&) = delete;
  BlobSceneFile& operator=(const BlobSceneFile&) = delete;

  [[nodiscard]] std::uint64_t size() const override { return size_; }
  [[nodiscard]] std::optional<std::size_t> read(std::span<char> to) override {
    while (true) {
      const ssize_t got = ::read(fd_, to.data(), to.size());
      if (got >= 0) return static_cast<std::size_t>(got);
      if (errno != EINTR) return std::nullopt;
    }
  }

 private:
  int fd_;
  std::uint64_t size_;
};

}  // namespace

BlobSceneFiles::BlobSceneFiles(const std::vector<BlobFile>& files) {
  for (const BlobFile& file : files) paths_[file.name] = file.path;
}

std::vector<std::string> BlobSceneFiles::names() const {
  std::vector<std::string> names;
  for (const auto& entry : paths_) names.push_back(entry.first);
  return names;
}

std::unique_ptr<render::SceneFile> BlobSceneFiles::open(const std::string& name) const {
  const auto found = paths_.find(name);
  if (found == paths_.end()) return nullptr;
  const int fd = ::open(found->second.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
  struct stat status {};
  if (fd < 0 || ::fstat(fd, &status) != 0 || !S_ISREG(status.st_mode)) {
    if (fd >= 0) ::close(fd);
    return nullptr;
  }
  return std::make_unique<BlobSceneFile>(fd, static_cast<std::uint64_t>(status.st_size));
}

}  // namespace raykiln::server
