// Durable steps on files. All errors carry the text of errno.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

#include "raykiln/base/result.hpp"

namespace raykiln::server {

/// An open file descriptor.
class OwnedFd {
 public:
  OwnedFd() = default;
  explicit OwnedFd(int fd) : fd_(fd) {}
  OwnedFd(OwnedFd&& other) noexcept : fd_(other.release()) {}
  OwnedFd& operator=(OwnedFd&& other) noexcept;
  ~OwnedFd();
  [[nodiscard]] int get() const { return fd_; }
  [[nodiscard]] bool is_open() const { return fd_ >= 0; }
  int release();

 private:
  int fd_ = -1;
};

/// The error of a failed system call: storage_full where the device has no room, else internal.
[[nodiscard]] Error disk_error(const std::string& what, int error_number);

[[nodiscard]] Result<OwnedFd> create_file(const std::filesystem::path& path);
Status write_all(int fd, std::span<const std::byte> bytes);
Status sync_file(int fd);
Status sync_directory(const std::filesystem::path& path);
Status make_directory(const std::filesystem::path& path);
/// rename(2), then fsync of the directory that gained the name.
Status move_into_place(const std::filesystem::path& from, const std::filesystem::path& to);
/// Removes a file or a whole directory; what is not there is no error.
void remove_quietly(const std::filesystem::path& path);

}  // namespace raykiln::server
