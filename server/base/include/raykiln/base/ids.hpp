// Opaque identifiers.
#pragma once

#include <string>
#include <string_view>

namespace raykiln::server {

/// `prefix` followed by 128 random bits of the operating system as 26 characters of [0-9a-v].
/// Throws std::runtime_error when the system has no randomness to give.
[[nodiscard]] std::string random_id(std::string_view prefix);

/// True for 1 to `max_length` characters of [A-Za-z0-9_-]: what may stand in a URL and a file name.
[[nodiscard]] bool is_plain_id(std::string_view text, std::size_t max_length = 128);

/// True for 64 lower-case hexadecimal digits.
[[nodiscard]] bool is_sha256_hex(std::string_view text);

}  // namespace raykiln::server
