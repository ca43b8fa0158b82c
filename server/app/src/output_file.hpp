#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace raykiln::server {

/// Writes a file whole or not at all; what went wrong, or nothing.
[[nodiscard]] std::optional<std::string> write_whole_file(const std::filesystem::path& path,
                                                          std::string_view bytes);

/// Tells that so many values of a half-float picture were beyond its range.
void say_clamped(const std::filesystem::path& path, const std::string& values);

}  // namespace raykiln::server
