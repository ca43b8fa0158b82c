// The request target, taken apart and percent-decoded.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace raykiln::server {

inline constexpr std::size_t kMaxSegments = 16;
inline constexpr std::size_t kMaxQueryParameters = 32;

struct Target {
  std::string path;                   ///< decoded, starts with '/'
  std::vector<std::string> segments;  ///< decoded; "/" has one empty segment
  std::vector<std::pair<std::string, std::string>> query;
};

/// Nothing when the target is not an absolute path with an optional query (origin form), when an
/// escape is bad, or when a decoded segment is "." or ".." or holds '/', '\\' or a control
/// character: no later step has to wonder what such a path means.
[[nodiscard]] std::optional<Target> parse_target(std::string_view text);

}  // namespace raykiln::server
