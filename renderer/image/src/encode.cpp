#include "raykiln/image/encode.hpp"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "raykiln/image/display.hpp"

namespace raykiln::render {
namespace {

constexpr float kLargestHalf = 65504.0F;
constexpr float kHalfVanishes = 0x1p-25F;  ///< half of the smallest denormal, and a tie goes to even

std::uint8_t display_byte(double linear) {
  return static_cast<std::uint8_t>(std::lround(255.0 * display_value(linear)));
}

/// display_byte() without a power for each value: where the byte steps up, found once a process, and
/// the byte at the start of each of kCells equal parts of [0, 1]. A part holds about one step at
/// most, so that what is left is a comparison or two.
class DisplayBytes {
 public:
  DisplayBytes() {
    for (std::size_t byte = 1; byte < steps_.size(); ++byte) {
      steps_[byte] = first_value_of(static_cast<int>(byte));
    }
    for (std::size_t cell = 0; cell < cells_.size(); ++cell) {
      cells_[cell] = display_byte(static_cast<double>(cell) / kCells);
    }
  }

  [[nodiscard]] std::uint8_t operator()(double linear) const {
    if (!(linear > 0.0)) return 0;  // NaN too
    if (linear >= 1.0) return 255;
    std::size_t byte = cells_[static_cast<std::size_t>(linear * kCells)];
    while (byte < 255 && linear >= steps_[byte + 1]) ++byte;
    return static_cast<std::uint8_t>(byte);
  }

 private:
  static constexpr int kCells = 4096;

  /// The smallest double that shows as `byte` or more.
  static double first_value_of(int byte) {
    double below = 0.0, enough = 1.0;
    while (true) {
      const double middle = below + 0.5 * (enough - below);
      if (!(below < middle && middle < enough)) return enough;
      (display_byte(middle) >= byte ? enough : below) = middle;
    }
  }

  std::array<double, 256> steps_{};
  std::array<std::uint8_t, kCells> cells_{};
};

OIIO::ImageSpec rgb_spec(const Image& image, OIIO::TypeDesc type) {
  OIIO::ImageSpec spec(image.width, image.height, 3, type);
  spec.channelnames = {"R", "G", "B"};
  return spec;
}

/// Writes to memory through the library's output proxy; both formats used here support it.
std::variant<Bytes, EncodeError> encode(const char* name, const OIIO::ImageSpec& spec,
                                        OIIO::TypeDesc type, const void* pixels) {
  Bytes bytes;
  OIIO::Filesystem::IOVecOutput sink(bytes);
  const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create(name);
  if (!output) return EncodeError{OIIO::geterror()};
  if (!output->supports("ioproxy") || !output->set_ioproxy(&sink)) {
    return EncodeError{std::string(name) + ": this build of OpenImageIO cannot write to memory"};
  }
  if (!output->open(name, spec) || !output->write_image(type, pixels) || !output->close()) {
    return EncodeError{output->geterror()};
  }
  return bytes;
}

bool consistent(const Image& image) {
  return image.width > 0 && image.height > 0 &&
         image.rgb.size() == 3 * static_cast<std::size_t>(image.width) *
                                 static_cast<std::size_t>(image.height);
}

/// What every EXR of this library says of itself.
void describe(OIIO::ImageSpec& spec, const std::map<std::string, std::string>& attributes) {
  spec.attribute("oiio:ColorSpace", "Linear");
  spec.attribute("compression", "zip");
  // Unless the caller gives a time, a fixed one: the library would write now, and equal pictures
  // would not be equal bytes.
  spec.attribute("DateTime", "1970:01:01 00:00:00");
  for (const auto& [key, value] : attributes) spec.attribute(key, value);
}

/// Where the values of one channel lie.
struct PlaneChannel {
  const float* first;
  std::size_t stride;
};

/// Linear EXR; the library converts from float to the file's type, rounding to nearest.
std::variant<Bytes, EncodeError> encode_linear(
    const Image& image, OIIO::TypeDesc file_type,
    const std::map<std::string, std::string>& attributes) {
  if (!consistent(image)) return EncodeError{"the picture has no pixels"};
  OIIO::ImageSpec spec = rgb_spec(image, file_type);
  describe(spec, attributes);
  return encode("a.exr", spec, OIIO::TypeDesc::FLOAT, image.rgb.data());
}

}  // namespace

std::variant<Bytes, EncodeError> encode_png(const Image& image, double exposure_stops,
                                            const std::string& note, PngEffort effort) {
  if (!consistent(image)) return EncodeError{"the picture has no pixels"};
  const double gain = std::exp2(exposure_stops);
  std::vector<std::uint8_t> display(image.rgb.size());
  static const DisplayBytes bytes;
  std::transform(image.rgb.begin(), image.rgb.end(), display.begin(),
                 [gain](float x) { return bytes(gain * static_cast<double>(x)); });
  OIIO::ImageSpec spec = rgb_spec(image, OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:ColorSpace", "sRGB");
  if (effort == PngEffort::kQuick) spec.attribute("png:compressionLevel", 1);
  if (!note.empty()) spec.attribute("ImageDescription", note);
  return encode("a.png", spec, OIIO::TypeDesc::UINT8, display.data());
}

std::variant<Bytes, EncodeError> encode_exr(const Image& image,
                                            const std::map<std::string, std::string>& attributes,
                                            std::span<const ExtraPlane> planes) {
  if (planes.empty()) return encode_linear(image, OIIO::TypeDesc::FLOAT, attributes);
  if (!consistent(image)) return EncodeError{"the picture has no pixels"};
  const std::size_t pixels = image.rgb.size() / 3;
  std::vector<std::string> names{"R", "G", "B"};
  std::vector<PlaneChannel> channels;
  for (std::size_t c = 0; c < 3; ++c) channels.push_back({&image.rgb[c], 3});
  for (const ExtraPlane& plane : planes) {
    const std::size_t of_plane = plane.values.size() / pixels;
    if (plane.values.size() != of_plane * pixels || (of_plane != 1 && of_plane != 3)) {
      return EncodeError{"plane " + plane.name + " does not fit the picture"};
    }
    for (std::size_t c = 0; c < of_plane; ++c) {
      if (c < plane.channels.size()) names.emplace_back(plane.channels[c]);
      else names.push_back(of_plane == 1 ? plane.name : plane.name + "." + "RGB"[c]);
      channels.push_back({&plane.values[c], of_plane});
    }
  }
  std::vector<float> interleaved(pixels * channels.size());
  for (std::size_t i = 0, at = 0; i < pixels; ++i) {
    for (const PlaneChannel& channel : channels) interleaved[at++] = channel.first[i * channel.stride];
  }
  OIIO::ImageSpec spec(image.width, image.height, static_cast<int>(channels.size()), OIIO::TypeDesc::FLOAT);
  spec.channelnames = names;
  describe(spec, attributes);
  return encode("a.exr", spec, OIIO::TypeDesc::FLOAT, interleaved.data());
}

HalfRange half_range(const Image& image) {
  HalfRange range;
  for (const float value : image.rgb) {
    range.vanished += value != 0.0F && std::abs(value) <= kHalfVanishes ? 1U : 0U;
    range.clamped += std::abs(value) > kLargestHalf ? 1U : 0U;
  }
  return range;
}

std::variant<HalfExr, EncodeError> encode_half_exr(
    const Image& image, const std::map<std::string, std::string>& attributes) {
  const HalfRange range = half_range(image);
  HalfExr result{.bytes = {}, .clamped = range.clamped, .vanished = range.vanished};
  Image fitting = image;
  for (float& value : fitting.rgb) {
    // NaN stays what it is
    if (std::abs(value) > kLargestHalf) value = std::copysign(kLargestHalf, value);
  }
  auto encoded = encode_linear(fitting, OIIO::TypeDesc::HALF, attributes);
  if (const auto* error = std::get_if<EncodeError>(&encoded)) return *error;
  result.bytes = std::move(std::get<Bytes>(encoded));
  return result;
}

std::uint64_t nan_values(const Image& image) {
  return static_cast<std::uint64_t>(std::count_if(image.rgb.begin(), image.rgb.end(),
                                                  [](float value) { return std::isnan(value); }));
}

void set_image_library_threads(int threads) {
  OIIO::attribute("threads", threads);
  OIIO::attribute("exr_threads", threads);
}

}  // namespace raykiln::render
