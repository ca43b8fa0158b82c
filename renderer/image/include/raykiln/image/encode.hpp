// Pictures as bytes. OpenImageIO is used behind this header and nowhere else.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "raykiln/image/film.hpp"

namespace raykiln::render {

using Bytes = std::vector<std::uint8_t>;
struct EncodeError {
  std::string message;
};

/// The bytes differ, the pixels do not.
enum class PngEffort {
  kSmall,
  kQuick,  ///< for a picture that is looked at once: several times as fast, somewhat larger
};

/// 8-bit sRGB PNG of exposure 2^stops times the picture, clipped to [0, 1] (NaN shows as black).
/// `note` becomes the text chunk "Description", if it is not empty.
[[nodiscard]] std::variant<Bytes, EncodeError> encode_png(const Image& image, double exposure_stops,
                                                          const std::string& note = {},
                                                          PngEffort effort = PngEffort::kSmall);

/// Further channels of an EXR, beside R, G and B.
struct ExtraPlane {
  std::string name;              ///< channel name; with three channels name.R, name.G, name.B
  std::span<const float> values; ///< 1 or 3 a pixel
  std::span<const std::string_view> channels{};  ///< names of the channels, if others
};

/// Linear float32 EXR with the given string attributes.
[[nodiscard]] std::variant<Bytes, EncodeError> encode_exr(
    const Image& image, const std::map<std::string, std::string>& attributes,
    std::span<const ExtraPlane> planes = {});

/// What half floats do to a picture.
struct HalfRange {
  std::uint64_t clamped = 0;   ///< values beyond +-65504
  std::uint64_t vanished = 0;  ///< values other than 0 that become 0: at most 2^-25
};
[[nodiscard]] HalfRange half_range(const Image& image);

/// The same in half floats, for half the bytes. They end at 65504: larger values, infinite ones too,
/// are clamped to it and counted, so that no file holds an infinity that the picture does not.
struct HalfExr {
  Bytes bytes;
  std::uint64_t clamped = 0;   ///< values beyond +-65504
  std::uint64_t vanished = 0;  ///< values other than 0 that became 0: at most 2^-25
};
[[nodiscard]] std::variant<HalfExr, EncodeError> encode_half_exr(
    const Image& image, const std::map<std::string, std::string>& attributes);

/// Channel values that are NaN: what encode_png shows as black. A film resolves to none.
[[nodiscard]] std::uint64_t nan_values(const Image& image);

/// Number of threads that the image library may start by itself (1 in a server that has its own pool).
void set_image_library_threads(int threads);

}  // namespace raykiln::render
