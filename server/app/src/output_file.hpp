#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace raykiln::server {

/// Writes a file whole or not at all; what went wrong, or nothing.
[[nodiscard]] std::optional<std::string> write_whole_file(const std::filesystem::path& path,
                                                          std::string_view bytes);

}  // namespace raykiln::server
