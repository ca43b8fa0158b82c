#include "file_ops.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <system_error>
#include <utility>

namespace raykiln::server {

OwnedFd& OwnedFd::operator=(OwnedFd&& other) noexcept {
  if (this != &other) {
    if (fd_ >= 0) ::close(fd_);
    fd_ = other.release();
  }
  return *this;
}
OwnedFd::~OwnedFd() {
  if (fd_ >= 0) ::close(fd_);
}
int OwnedFd::release() { return std::exchange(fd_, -1); }

Error disk_error(const std::string& what, int error_number) {
  if (error_number == ENOSPC || error_number == EDQUOT) {
    return {ErrorKind::kStorageFull, "storage_full", "the disk of the store is full", ""};
  }
  return {ErrorKind::kInternal, "internal",
          what + ": " + std::generic_category().message(error_number), ""};
}

Result<OwnedFd> create_file(const std::filesystem::path& path) {
  const int fd = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0600);
  if (fd < 0) return disk_error("cannot create a file of the store", errno);
  return OwnedFd(fd);
}

Status write_all(int fd, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(fd, bytes.data(), bytes.size());
    if (written < 0) {
      if (errno == EINTR) continue;
      return disk_error("cannot write a file of the store", errno);
    }
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return success();
}

Status sync_file(int fd) {
  if (::fsync(fd) != 0) return disk_error("cannot flush a file of the store", errno);
  return success();
}

Status sync_directory(const std::filesystem::path& path) {
  const OwnedFd fd(::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!fd.is_open()) return disk_error("cannot open a directory of the store", errno);
  return sync_file(fd.get());
}

Status make_directory(const std::filesystem::path& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error) return disk_error("cannot create " + path.string(), error.value());
  return success();
}

Status move_into_place(const std::filesystem::path& from, const std::filesystem::path& to) {
  if (std::rename(from.c_str(), to.c_str()) != 0) {
    return disk_error("cannot rename a file of the store", errno);
  }
  return sync_directory(to.parent_path());
}

void remove_quietly(const std::filesystem::path& path) {
  std::error_code ignored;  // Clean-up: what stays is removed at the next start.
  std::filesystem::remove_all(path, ignored);
}

}  // namespace raykiln::server
