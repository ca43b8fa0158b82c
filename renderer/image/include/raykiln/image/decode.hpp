// Pictures from bytes, hostile ones too: what encode.hpp writes, and EXR and PNG of other programs.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "raykiln/image/film.hpp"

namespace raykiln::render {

inline constexpr std::uint64_t kMostDecodedPixels = std::uint64_t{1} << 28U;
inline constexpr int kMostDecodedChannels = 64;
/// Pixels x channels, 4 bytes each while a file is read: a header of some bytes may claim them.
inline constexpr std::uint64_t kMostDecodedValues = std::uint64_t{1} << 30U;

struct DecodedImage {
  Image image;           ///< linear, or display values in [0, 1] of a PNG
  bool display = false;  ///< true: a PNG
  std::vector<float> error;    ///< channels error.R, error.G, error.B: 3 a pixel; empty if not all there
  std::vector<float> samples;  ///< channel samples: 1 a pixel; empty if not there
  std::map<std::string, std::string> attributes;  ///< string attributes that begin with "raykiln:"
};
struct DecodeError {
  std::string message;
};

/// EXR or PNG, told by the first bytes. Of an EXR the first part is read, and in it channels R, G, B, or
/// X.R, X.G, X.B of its first layer, or a single channel for all three. Alpha is left out.
[[nodiscard]] std::variant<DecodedImage, DecodeError> decode_image(std::span<const std::uint8_t> bytes);

/// The picture as display values at an exposure of 2^stops.
[[nodiscard]] Image display_values(const Image& linear, double exposure_stops);

}  // namespace raykiln::render
