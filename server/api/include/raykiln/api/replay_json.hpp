// One sample rendered again, as JSON and back.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace raykiln::server {

/// Schema Replay.
struct ReplayView {
  int x = 0, y = 0;
  std::uint64_t sample = 0;
  std::array<double, 3> radiance{};  ///< as it would be added to the pixel, finite or not
  bool dropped = false;              ///< not finite: counted, not added
  bool truncated = false;            ///< cut at the path limit while it could go on
  std::uint64_t bounce_rays = 0, shadow_rays = 0;
  std::string light_model;           ///< with its overrides
  std::uint64_t seed = 0;
  std::string effects;               ///< label, as pictures carry it
};

/// On one line. A channel that is not finite is the string "nan", "inf" or "-inf".
[[nodiscard]] std::string replay_json(const ReplayView& replay);
/// Nothing when the text is none.
[[nodiscard]] std::optional<ReplayView> parse_replay(std::string_view text);

}  // namespace raykiln::server
