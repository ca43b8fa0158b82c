// Pictures that scenes bring along, from bytes of strangers: textures and environment maps.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace raykiln::render {

enum class PictureFormat : std::uint8_t { kPng, kJpeg, kExr, kHdr };

/// Told by the first bytes, never by a name.
[[nodiscard]] std::optional<PictureFormat> picture_format(std::span<const std::uint8_t> bytes);
[[nodiscard]] std::string_view name(PictureFormat format);

/// What of a picture is read.
enum class PictureChannels : std::uint8_t {
  kColour,       ///< three values; alpha is left out and has not been multiplied in
  kAlpha,        ///< one: alpha; of a picture without, nothing
  kAlphaOrGrey,  ///< one: alpha; of a picture without, the mean of its colours as they are stored
};

/// Row 0 at the top. One of the two is filled; none where alpha was asked for and is not there.
struct PictureFile {
  PictureFormat format = PictureFormat::kPng;
  int width = 0, height = 0;
  std::vector<std::uint8_t> srgb8;  ///< PNG and JPEG of 8 bits: sRGB display values
  std::vector<float> linear;  ///< EXR and HDR as they are; PNG of 16 bits with sRGB's curve undone
  int channels = 3;           ///< values a pixel: 3, or 1 without sRGB's curve
};
struct PictureFileError {
  std::string message;
  bool no_room = false;  ///< it is larger than max_bytes
};
struct PictureFileLimits {
  std::uint64_t max_pixels = 0;
  std::uint64_t max_bytes = UINT64_MAX;  ///< of the values that are returned
};

/// A PNG, JPEG, EXR or Radiance HDR picture within the limits. The header is checked before anything
/// of the picture's size is allocated. Linear values may be anything a file can hold.
[[nodiscard]] std::variant<PictureFile, PictureFileError> read_picture_file(
    std::span<const std::uint8_t> bytes, const PictureFileLimits& limits,
    PictureChannels channels = PictureChannels::kColour);

}  // namespace raykiln::render
