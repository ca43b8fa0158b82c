#include "output_file.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iostream>

namespace raykiln::server {

std::optional<std::string> write_whole_file(const std::filesystem::path& path,
                                            std::string_view bytes) {
  const std::filesystem::path part = path.string() + '.' + std::to_string(getpid()) + ".part";
  const auto fail = [&](const std::string& why) {
    std::error_code ignored;  // there may be nothing to remove
    std::filesystem::remove(part, ignored);
    return path.string() + ": " + why;
  };
  std::ofstream out(part, std::ios::binary);
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  out.close();
  if (!out) return fail(std::strerror(errno));
  std::error_code error;
  std::filesystem::rename(part, path, error);
  if (error) return fail(error.message());
  return std::nullopt;
}

void say_clamped(const std::filesystem::path& path, const std::string& values) {
  std::cerr << "warning: " << path.string() << ": " << values
            << " values are beyond 65504 and were clamped to it\n";
}

}  // namespace raykiln::server
