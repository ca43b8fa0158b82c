// Which channels of a file are its colour.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace raykiln::render {

using ChannelNames = std::vector<std::string>;

[[nodiscard]] std::optional<std::size_t> channel_position(const ChannelNames& names,
                                                          const std::string& name);

/// Channels `layer`R, `layer`G, `layer`B, if all are there.
[[nodiscard]] std::optional<std::array<std::size_t, 3>> channel_triple(const ChannelNames& names,
                                                                       const std::string& layer);

/// Channels of the picture proper; nothing when the file has no colour that could be meant.
[[nodiscard]] std::optional<std::array<std::size_t, 3>> colour_channels(const ChannelNames& names);

}  // namespace raykiln::render
