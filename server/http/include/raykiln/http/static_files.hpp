// The page's files, held in memory: compiled in, or read once from a folder.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "raykiln/api/message.hpp"

namespace raykiln::server {

class StaticFiles {
 public:
  void add(std::string path, std::string bytes);

  /// Reads a folder, symbolic links left out; false when it cannot be read or is over the bounds
  /// (1000 files, 64 MiB together).
  [[nodiscard]] bool add_directory(const std::filesystem::path& directory);

  /// 200, or 304 when `if_none_match` names the file's ETag; nothing when there is no such file.
  [[nodiscard]] std::optional<Response> get(std::string_view path,
                                            const std::string* if_none_match) const;

 private:
  struct File {
    SharedBytes bytes;
    std::string type;
    std::string etag;
  };
  std::map<std::string, File, std::less<>> files_;
};

/// Media type by the file name's extension.
[[nodiscard]] std::string_view media_type(std::string_view path);

}  // namespace raykiln::server
