#include "colour_channels.hpp"

#include <algorithm>

namespace raykiln::render {

std::optional<std::size_t> channel_position(const ChannelNames& names, const std::string& name) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) return std::nullopt;
  return static_cast<std::size_t>(found - names.begin());
}

std::optional<std::array<std::size_t, 3>> channel_triple(const ChannelNames& names, const std::string& layer) {
  const auto r = channel_position(names, layer + "R"), g = channel_position(names, layer + "G"), b = channel_position(names, layer + "B");
  if (!r || !g || !b) return std::nullopt;
  return std::array<std::size_t, 3>{*r, *g, *b};
}

std::optional<std::array<std::size_t, 3>> colour_channels(const ChannelNames& names) {
  if (auto plain = channel_triple(names, "")) return plain;
  for (const std::string& name : names) {
    const bool red = name.size() > 2 && name.ends_with(".R");
    if (!red) continue;
    if (auto layer = channel_triple(names, name.substr(0, name.size() - 1))) return layer;
  }
  const bool grey = names.size() == 1 || (names.size() == 2 && channel_position(names, "A"));
  if (grey) {
    const std::size_t only = names.size() == 2 && names.front() == "A" ? 1 : 0;
    return std::array<std::size_t, 3>{only, only, only};
  }
  if (const auto y = channel_position(names, "Y")) return std::array<std::size_t, 3>{*y, *y, *y};
  return std::nullopt;
}

}  // namespace raykiln::render
