// The URIs by which glTF names its buffers.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace raykiln::render::io {

/// RFC 4648 with or without padding; nothing when a character does not belong or bits are left over.
[[nodiscard]] std::optional<std::string> decode_base64(std::string_view text);

/// "%20" -> " "; nothing when an escape is incomplete or decodes to a zero byte.
[[nodiscard]] std::optional<std::string> decode_percent(std::string_view text);

/// True when the reference begins with a scheme ("data:", "https:", ...).
[[nodiscard]] bool has_scheme(std::string_view uri);

/// The base64 part of "data:...;base64,...", or nothing for other URIs.
[[nodiscard]] std::optional<std::string_view> base64_part(std::string_view uri);

}  // namespace raykiln::render::io
