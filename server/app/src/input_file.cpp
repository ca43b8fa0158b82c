#include "input_file.hpp"

#include <fstream>

namespace raykiln::server {

Result<std::vector<std::uint8_t>> read_whole_file(const std::filesystem::path& path, std::uint64_t most) {
  std::error_code error;
  const auto size = std::filesystem::file_size(path, error);
  if (error) return Error{ErrorKind::kNotFound, "file_missing", error.message(), path.string()};
  if (size > most) return Error{ErrorKind::kTooLarge, "payload_too_large", "the file is too large", path.string()};
  std::vector<std::uint8_t> bytes(size);
  std::ifstream in(path, std::ios::binary);
  in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  if (!in) return Error{ErrorKind::kNotFound, "file_missing", "the file cannot be read", path.string()};
  return bytes;
}

}  // namespace raykiln::server
