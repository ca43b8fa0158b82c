// File names of strangers.
#pragma once

#include <cstddef>
#include <string_view>

namespace raykiln::server {

/// True for a relative name of 1 to `max_bytes` bytes whose parts between '/' are not empty, "." or
/// "..", without backslashes, colons in front ("C:") and control characters. Such a name stays inside
/// the upload; even so it is never used as a path.
[[nodiscard]] bool is_safe_file_name(std::string_view name, std::size_t max_bytes);

}  // namespace raykiln::server
