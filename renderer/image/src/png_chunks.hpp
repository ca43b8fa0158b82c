// Whether a PNG file is all there, before a library that cannot fail cleanly reads it.
#pragma once

#include <cstdint>
#include <span>

namespace raykiln::render {

/// The signature, then chunks of length, type, data and check sum that fit into the file, the last of them IEND
/// (ISO/IEC 15948, 5.3). Says nothing about what the chunks hold.
[[nodiscard]] bool png_is_whole(std::span<const std::uint8_t> bytes);

}  // namespace raykiln::render
