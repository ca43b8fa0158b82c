#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "raykiln/base/result.hpp"

namespace raykiln::server {

/// The whole file. kNotFound "file_missing", kTooLarge "payload_too_large" above `most` bytes.
[[nodiscard]] Result<std::vector<std::uint8_t>> read_whole_file(const std::filesystem::path& path,
                                                                std::uint64_t most);

}  // namespace raykiln::server
