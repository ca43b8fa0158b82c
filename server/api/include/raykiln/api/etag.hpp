// Entity tags (RFC 9110, 8.8.3 and 13.1.2).
#pragma once

#include <string_view>

namespace raykiln::server {

/// Does an If-None-Match value name this ETag (weak comparison, lists, `*`)?
[[nodiscard]] bool etag_matches(std::string_view if_none_match, std::string_view etag);

}  // namespace raykiln::server
